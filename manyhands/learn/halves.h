// Work in two fixed halves, on one or two threads, with the same result to the bit.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>
#include <type_traits>

#include "manyhands/learn/contest.h"

namespace manyhands::learn {

/// Runs body(0) and body(1), each exactly once: the second on a helper thread if there is one, it is free in time, and
/// it pays (contest.h).
///
/// What a half does must not depend on the other, so neither threads nor their timing ever show in the results.
class Halves {
 public:
  /// `num_threads` 1: both halves run in turn on the calling thread; 2 or more: a helper thread may take the second.
  explicit Halves(int num_threads);
  ~Halves();
  Halves(const Halves&) = delete;
  Halves& operator=(const Halves&) = delete;

  /// Returns when both halves are done. `body` must not throw.
  template <class Body>
  void run(Body&& body) {
    if (!helper_.joinable()) {
      body(0);
      body(1);
      return;
    }
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    if (contest_.with_helper()) {
      share<std::remove_reference_t<Body>>(body);
    } else {
      body(0);
      body(1);
    }
    contest_.record(Clock::now() - begin);
  }

 private:
  template <class Body>
  void share(Body& body) {
    context_ = &body;
    call_ = [](void* context) { (*static_cast<Body*>(context))(1); };
    post();
    body(0);
    if (claim(posted_.load(std::memory_order_relaxed))) {  // a busy machine has not let the helper run yet
      body(1);
    } else {
      wait();
    }
  }

  void post();
  bool claim(unsigned round);
  void wait();
  void serve();

  void* context_ = nullptr;
  void (*call_)(void*) = nullptr;
  std::atomic<unsigned> posted_ = 0, claimed_ = 0, finished_ = 0;  // number of the last such round
  std::atomic<bool> stop_ = false;
  Contest contest_;
  std::thread helper_;
};

}  // namespace manyhands::learn
