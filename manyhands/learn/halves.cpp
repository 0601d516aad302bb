#include "manyhands/learn/halves.h"

namespace manyhands::learn {

namespace {

/// About 20 us: longer than the gaps inside a gradient step, short enough to leave an idle core alone.
constexpr int kSpins = 2000;

void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Blocks until `counter` differs from `old`: spinning at first, because the wait is mostly a few microseconds.
void await_change(const std::atomic<unsigned>& counter, unsigned old) {
  for (int spin = 0; spin < kSpins; ++spin) {
    if (counter.load(std::memory_order_acquire) != old) return;
    relax();
  }
  counter.wait(old, std::memory_order_acquire);
}

}  // namespace

Halves::Halves(int num_threads) {
  if (num_threads > 1) helper_ = std::thread([this] { serve(); });
}

Halves::~Halves() {
  if (!helper_.joinable()) return;
  stop_.store(true, std::memory_order_relaxed);
  post();
  helper_.join();
}

void Halves::post() {
  posted_.fetch_add(1, std::memory_order_release);
  posted_.notify_one();
}

/// Whether the caller is the first to ask for the second half of the round.
bool Halves::claim(unsigned round) {
  unsigned before = round - 1;
  return claimed_.compare_exchange_strong(before, round, std::memory_order_acq_rel);
}

void Halves::wait() {
  const unsigned round = posted_.load(std::memory_order_relaxed);
  for (unsigned seen = finished_.load(std::memory_order_acquire); seen != round;
       seen = finished_.load(std::memory_order_acquire)) {
    await_change(finished_, seen);
  }
}

void Halves::serve() {
  for (unsigned seen = 0;;) {
    await_change(posted_, seen);
    seen = posted_.load(std::memory_order_acquire);
    if (stop_.load(std::memory_order_relaxed)) return;
    if (!claim(seen)) continue;
    call_(context_);
    finished_.store(seen, std::memory_order_release);
    finished_.notify_one();
  }
}

}  // namespace manyhands::learn
