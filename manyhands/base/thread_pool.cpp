#include "manyhands/base/thread_pool.h"

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "manyhands/base/float_environment.h"
#include "manyhands/base/system.h"

namespace manyhands {

namespace {

constexpr int kMaxThreads = 1024;
constexpr std::uint32_t kOpen = 1u << 31;  // of the gate; below it the number of workers inside

/// Short rounds follow one another closely and waking a sleeping thread costs more than to look around for a while,
/// unless the cores are wanted by other workers.
int spins_for(int num_threads) {
  constexpr int kSpins = 2000;
  return static_cast<unsigned>(num_threads) <= std::thread::hardware_concurrency() ? kSpins : 0;
}

}  // namespace

ThreadPool::ThreadPool(int num_threads) : process_(system::process_id()), spins_(spins_for(num_threads)) {
  if (num_threads < 1 || num_threads > kMaxThreads) {
    throw std::invalid_argument("num_threads is " + std::to_string(num_threads) + "; expected 1 to 1024");
  }
  for (int worker = 1; worker < num_threads; ++worker) {
    threads_.emplace_back([this, worker] { serve(worker); });
  }
}

ThreadPool::~ThreadPool() {
  if (process_ != system::process_id()) work_alone();
  stop_ = true;
  ++round_;
  round_.notify_all();
}

/// In a child of fork(): the threads are the parent's, and so is the round that they may be in.
void ThreadPool::work_alone() {
  for (std::jthread& thread : threads_) thread.detach();
  threads_.clear();
  gate_ = 0;
  process_ = system::process_id();
}

void ThreadPool::run(int n, Call call, void* context) {
  if (process_ != system::process_id()) work_alone();
  n_ = n;
  call_ = call;
  context_ = context;
  next_ = 0;
  if (n > 1 && !threads_.empty()) {
    gate_ = kOpen;
    ++round_;
    round_.notify_all();
  }
  {
    const FloatEnvironment floats;
    work(0);
  }
  // Nothing is left to take. A worker whose core another program holds may not even have woken up: it is not waited
  // for.
  gate_ &= ~kOpen;
  for (std::uint32_t inside = gate_; inside != 0; inside = gate_) gate_.wait(inside);
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

void ThreadPool::work(int worker) {
  for (int item = next_++; item < n_; item = next_++) {
    try {
      call_(context_, item, worker);
    } catch (...) {
      const std::scoped_lock lock(error_mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }
}

void ThreadPool::serve(int worker) {
  const FloatEnvironment floats;
  std::uint32_t seen = 0;
  while (true) {
    for (int spin = 0; spin < spins_ && round_ == seen; ++spin) std::this_thread::yield();
    round_.wait(seen);
    seen = round_;
    if (stop_) return;
    if (!enter()) continue;
    work(worker);
    leave();
  }
}

/// False if the round is over already.
bool ThreadPool::enter() {
  std::uint32_t gate = gate_;
  while ((gate & kOpen) != 0) {
    if (gate_.compare_exchange_weak(gate, gate + 1)) return true;
  }
  return false;
}

void ThreadPool::leave() {
  if (--gate_ == 0) gate_.notify_all();
}

int choose_num_threads(int requested) {
  if (requested > 0) return requested;
  if (const char* text = std::getenv("MANYHANDS_THREADS"); text != nullptr && *text != '\0') {
    int value = 0;
    const char* end = text + std::strlen(text);
    const auto [rest, error] = std::from_chars(text, end, value);
    if (error != std::errc() || rest != end || value < 1 || value > kMaxThreads) {
      throw std::invalid_argument(std::string("the variable MANYHANDS_THREADS is '") + text +
                                  "'; expected a whole number from 1 to 1024");
    }
    return value;
  }
  const unsigned cores = std::thread::hardware_concurrency();
  return cores == 0 ? 1 : static_cast<int>(cores);
}

}  // namespace manyhands
