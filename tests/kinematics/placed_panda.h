// A Panda, and where its hand is.
#pragma once

#include "manyhands/envs/panda.h"
#include "manyhands/kinematics/inverse_kinematics.h"

namespace manyhands::testing {

template <Real R>
struct PlacedPanda {
  LonePanda robot;
  Tree<R> tree{robot.model};
  ParamsStorage<R> params{robot.model};
  Workspace<R> ws{tree};

  /// Of the chain's frame in the world, at q (nq).
  Transform<R> pose(const IkChain& chain, const R* q) {
    forward_kinematics(tree, q, ws);
    return frame_pose(chain.body, broadcast<R>(chain.X_BF), ws);
  }
  Transform<R> hand(const R* q) { return pose(robot.arm.chain, q); }
};

}  // namespace manyhands::testing
