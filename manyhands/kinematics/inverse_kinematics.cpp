#include "manyhands/kinematics/inverse_kinematics.h"

#include <algorithm>

namespace manyhands {

IkChain::IkChain(const Model& model, FrameId frame) : body(model.frame(frame).body), X_BF(model.frame(frame).X_BF) {
  for (BodyId b = body; b.value() != 0; b = model.body(b).parent) {
    const Body& link = model.body(b);
    if (link.nq != 1) {
      throw ModelError("inverse kinematics of frame '" + model.frame(frame).name + "': joint '" +
                       model.joint(link.joint).name + "' is " + to_string(link.type) +
                       "; only joints of one degree of freedom can be solved for");
    }
    bodies.push_back(b.index());
    dofs.push_back(static_cast<std::size_t>(link.iv));
  }
  if (bodies.empty()) throw ModelError("no joint moves frame '" + model.frame(frame).name + "'");
  std::ranges::reverse(bodies);
  std::ranges::reverse(dofs);
}

}  // namespace manyhands
