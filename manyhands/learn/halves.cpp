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

void Halves::wait() {
  const unsigned target = posted_.load(std::memory_order_relaxed);
  if (finished_.load(std::memory_order_acquire) != target) await_change(finished_, target - 1);
}

void Halves::serve() {
  for (unsigned served = 0;; ++served) {
    await_change(posted_, served);
    if (stop_.load(std::memory_order_relaxed)) return;
    call_(context_);
    finished_.fetch_add(1, std::memory_order_release);
    finished_.notify_one();
  }
}

}  // namespace manyhands::learn
