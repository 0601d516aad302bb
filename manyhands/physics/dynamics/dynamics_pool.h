// Lends BatchDynamics objects of one model to any number of threads.
#pragma once

#include <mutex>

#include "manyhands/physics/dynamics/batch_dynamics.h"

namespace manyhands {

/// Keeps the scratch of past calls for the next: a call allocates only when more threads call at once than ever before,
/// or with a width not used before. The model must outlive the pool.
template <Real R>
class DynamicsPool {
 public:
  explicit DynamicsPool(const Model& model) : model_(&model) {}

  /// Calls `body(dynamics)` with an object of this width that no other thread uses. Throws as BatchDynamics does.
  template <class Body>
  void use(int width, Body&& body) {
    BatchDynamics<R> dynamics = take(width);
    body(dynamics);
    const std::scoped_lock lock(mutex_);
    idle_.push_back({width, std::move(dynamics)});
  }

 private:
  struct Idle {
    int width;
    BatchDynamics<R> dynamics;
  };

  BatchDynamics<R> take(int width) {
    {
      const std::scoped_lock lock(mutex_);
      for (Idle& idle : idle_) {
        if (idle.width != width) continue;
        std::swap(idle, idle_.back());
        BatchDynamics<R> dynamics = std::move(idle_.back().dynamics);
        idle_.pop_back();
        return dynamics;
      }
    }
    return BatchDynamics<R>(*model_, width);
  }

  const Model* model_;
  std::mutex mutex_;
  std::vector<Idle> idle_;
};

}  // namespace manyhands
