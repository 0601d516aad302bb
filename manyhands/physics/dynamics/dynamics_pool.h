// Lends objects with scratch of their own, of one model, to any number of threads.
#pragma once

#include <mutex>

#include "manyhands/base/process_mutex.h"
#include "manyhands/physics/dynamics/batch_dynamics.h"

namespace manyhands {

/// Keeps the scratch of past calls for the next: a call allocates only when more threads call at once than ever before,
/// or with a width not used before. An Object is made from a model and a width. The model must outlive the pool.
template <class Object>
class ModelPool {
 public:
  explicit ModelPool(const Model& model) : model_(&model) {}

  /// Calls `body(object)` with one of this width that no other thread uses. Throws as making an Object does.
  template <class Body>
  void use(int width, Body&& body) {
    Object object = take(width);
    body(object);
    const std::scoped_lock lock(mutex_);
    idle_.push_back({width, std::move(object)});
  }

 private:
  struct Idle {
    int width;
    Object object;
  };

  Object take(int width) {
    {
      const std::scoped_lock lock(mutex_);
      for (Idle& idle : idle_) {
        if (idle.width != width) continue;
        std::swap(idle, idle_.back());
        Object object = std::move(idle_.back().object);
        idle_.pop_back();
        return object;
      }
    }
    return Object(*model_, width);
  }

  const Model* model_;
  ProcessMutex mutex_;
  std::vector<Idle> idle_;
};

template <Real R>
using DynamicsPool = ModelPool<BatchDynamics<R>>;

}  // namespace manyhands
