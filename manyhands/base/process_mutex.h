// A mutex of one process: fork() copies no threads, so that in a child nobody would ever unlock what another thread of
// the parent held.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "manyhands/base/system.h"

namespace manyhands {

/// A mutex that a child of fork() finds open. What it guards is then as that thread had left it.
class ProcessMutex {
 public:
  void lock() { own().lock(); }
  bool try_lock() { return own().try_lock(); }
  void unlock() { mutex_->unlock(); }

 private:
  std::mutex& own() {
    int known = process_;
    if (const int here = system::process_id(); known != here && process_.compare_exchange_strong(known, here)) {
      (void)mutex_.release();  // may be locked, so that it must not be destroyed
      mutex_ = std::make_unique<std::mutex>();
    }
    return *mutex_;
  }

  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
  std::atomic<int> process_ = system::process_id();
};

}  // namespace manyhands
