// A few threads that share the blocks of a batch.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace manyhands {

/// Keeps `num_threads - 1` threads waiting; the caller is the last worker. Which worker takes which item is left to
/// chance, so an item's result must not depend on the worker: each worker only lends its scratch.
class ThreadPool {
 public:
  /// Throws std::invalid_argument unless 1 <= num_threads <= 1024.
  explicit ThreadPool(int num_threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  [[nodiscard]] int num_threads() const { return static_cast<int>(threads_.size()) + 1; }

  /// Calls body(item, worker) once for every item in [0, n), and returns when all are done. The first exception of a
  /// body is thrown again here. One caller at a time.
  template <class Body>
  void for_each(int n, Body&& body) {
    run(
        n,
        [](void* context, int item, int worker) {
          (*static_cast<std::remove_reference_t<Body>*>(context))(item, worker);
        },
        const_cast<void*>(static_cast<const void*>(&body)));
  }

 private:
  using Call = void (*)(void*, int, int);
  void run(int n, Call call, void* context);
  void work(int worker);
  void serve(int worker);
  bool enter();
  void leave();
  void work_alone();

  std::atomic<std::uint32_t> round_{0};  // changes when there is work
  std::atomic<std::uint32_t> gate_{0};   // whether workers may still take part in the round, and how many do
  std::atomic<int> next_{0};
  std::atomic<bool> stop_{false};
  int n_ = 0;
  Call call_ = nullptr;
  void* context_ = nullptr;
  int process_;  // fork() copies no threads: a child works alone
  int spins_;
  std::mutex error_mutex_;
  std::exception_ptr error_;
  std::vector<std::jthread> threads_;  // last: joined before what they use is gone
};

/// `requested` if it is positive, else the variable MANYHANDS_THREADS, else the number of cores.
/// Throws std::invalid_argument if the variable is not a whole number from 1 to 1024.
[[nodiscard]] int choose_num_threads(int requested);

}  // namespace manyhands
