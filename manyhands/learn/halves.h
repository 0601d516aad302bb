// Work in two fixed halves, on one or two threads, with the same result to the bit.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

namespace manyhands::learn {

/// Judges whether a helper is worth its while. Where another program wants its core it is put aside now and then in the
/// middle of its half, and the caller waits for milliseconds: then it is faster to work alone for some rounds, for more
/// each time that sharing turns out to lose again. All times in seconds.
class SharingJudge {
 public:
  /// Whether to share this round.
  [[nodiscard]] bool share();

  /// After a shared round: sharing saved about as much as the caller's own half took, and cost the wait for the other.
  void record(double own, double waited);

 private:
  double balance_ = 0;              // saved less lost in the latest rounds
  int pause_ = 0, alone_left_ = 0;  // rounds
};

/// Runs body(0) and body(1), each exactly once: the second on a helper thread if there is one and it is free in time.
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
    if (!helper_.joinable() || !judge_.share()) {
      body(0);
      body(1);
      return;
    }
    context_ = &body;
    call_ = [](void* context) { (*static_cast<std::remove_reference_t<Body>*>(context))(1); };
    post();
    const auto begin = std::chrono::steady_clock::now();
    body(0);
    if (claim(posted_.load(std::memory_order_relaxed))) {  // a busy machine has not let the helper run yet
      body(1);
    } else {
      const auto done = std::chrono::steady_clock::now();
      wait();
      judge_.record(seconds(done - begin), seconds(std::chrono::steady_clock::now() - done));
    }
  }

 private:
  static double seconds(std::chrono::steady_clock::duration time) {
    return std::chrono::duration<double>(time).count();
  }
  void post();
  bool claim(unsigned round);
  void wait();
  void serve();

  SharingJudge judge_;
  void* context_ = nullptr;
  void (*call_)(void*) = nullptr;
  std::atomic<unsigned> posted_ = 0, claimed_ = 0, finished_ = 0;  // number of the last such round
  std::atomic<bool> stop_ = false;
  std::thread helper_;
};

}  // namespace manyhands::learn
