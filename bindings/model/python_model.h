// What a Python Model holds: the C++ model, and scratch for its dynamics.
#pragma once

#include <memory>
#include <utility>

#include "manyhands/physics/dynamics/dynamics_pool.h"

namespace manyhands {

struct ControlPools;
struct IkPool;

struct PythonModel {
  explicit PythonModel(Model m) : PythonModel(std::make_shared<const Model>(std::move(m))) {}
  explicit PythonModel(std::shared_ptr<const Model> m) : model(std::move(m)), doubles(*model), floats(*model) {}

  template <Real R>
  [[nodiscard]] DynamicsPool<R>& pool() {
    if constexpr (std::same_as<R, double>) {
      return doubles;
    } else {
      return floats;
    }
  }

  std::shared_ptr<const Model> model;
  DynamicsPool<double> doubles;
  DynamicsPool<float> floats;
  std::shared_ptr<ControlPools> control;  ///< made by the first call of a controller
  std::shared_ptr<IkPool> ik;             ///< made by the first search of inverse kinematics
};

}  // namespace manyhands
