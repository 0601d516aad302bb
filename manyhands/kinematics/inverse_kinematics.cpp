#include "manyhands/kinematics/inverse_kinematics.h"

#include <algorithm>

namespace manyhands {

namespace {

/// The bodies that move a body, from the root out, itself included.
std::vector<BodyId> way_to(const Model& model, BodyId body) {
  std::vector<BodyId> way;
  for (BodyId b = body; b.value() != 0; b = model.body(b).parent) way.push_back(b);
  std::ranges::reverse(way);
  return way;
}

std::size_t dof_of(const Model& model, BodyId body, FrameId frame) {
  const Body& link = model.body(body);
  if (link.nq == 1) return static_cast<std::size_t>(link.iv);
  throw ModelError("inverse kinematics of frame '" + model.frame(frame).name + "': joint '" +
                   model.joint(link.joint).name + "' is " + to_string(link.type) +
                   "; only joints of one degree of freedom can be solved for");
}

}  // namespace

IkChain::IkChain(const Model& model, FrameId frame) : body(model.frame(frame).body), X_BF(model.frame(frame).X_BF) {
  for (const BodyId b : way_to(model, body)) {
    bodies.push_back(b.index());
    dofs.push_back(dof_of(model, b, frame));
  }
  if (bodies.empty()) throw ModelError("no joint moves frame '" + model.frame(frame).name + "'");
}

IkChain::IkChain(const Model& model, FrameId frame, FrameId relative_to)
    : body(model.frame(frame).body),
      X_BF(model.frame(frame).X_BF),
      base(Base{model.frame(relative_to).body, model.frame(relative_to).X_BF}) {
  const std::vector<BodyId> own = way_to(model, body), others = way_to(model, base->body);
  const auto [own_branch, other_branch] = std::ranges::mismatch(own, others);
  base->moved_by.assign(static_cast<std::size_t>(model.nv()), 0);
  for (auto b = own_branch; b != own.end(); ++b) dofs.push_back(dof_of(model, *b, frame));
  for (auto b = other_branch; b != others.end(); ++b) {
    dofs.push_back(dof_of(model, *b, relative_to));
    base->moved_by[dofs.back()] = 1;
  }
  if (dofs.empty()) {
    throw ModelError("no joint moves frame '" + model.frame(frame).name + "' relative to '" +
                     model.frame(relative_to).name + "'");
  }
  for (const BodyId b : own) bodies.push_back(b.index());
  for (auto b = other_branch; b != others.end(); ++b) bodies.push_back(b->index());
}

}  // namespace manyhands
