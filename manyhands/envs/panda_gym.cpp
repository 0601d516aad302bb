#include "manyhands/envs/panda_gym.h"

#include <algorithm>
#include <stdexcept>

#include "manyhands/envs/arm.h"
#include "manyhands/envs/object.h"

namespace manyhands {

namespace {

struct FreeBody {
  std::size_t iq, iv;
  RigidInertia<double> inertia;
};

FreeBody find(const World& world, const std::string& name) {
  const Model& model = world.model();
  const Link& link = model.link(model.link_id(name));
  const Body& body = model.body(link.body);
  if (body.type != JointType::kFloating || body.parent.value() != 0)
    throw std::invalid_argument("link '" + name + "' does not move freely");
  RigidInertia<double> inertia = link.inertial.about_origin();
  const double grown = world.mass(name) / link.inertial.mass;  // the world may have been told another mass
  inertia.m *= grown;
  for (double* moment : {&inertia.I.xx, &inertia.I.yy, &inertia.I.zz}) *moment *= grown;
  return {static_cast<std::size_t>(body.iq), static_cast<std::size_t>(body.iv), inertia};
}

}  // namespace

void step_in_air(World& world, int n, std::span<const std::string> links) {
  if (links.empty()) return world.step(n);
  std::vector<FreeBody> bodies;
  for (const std::string& name : links) bodies.push_back(find(world, name));
  std::vector<double> tau(world.tau().begin(), world.tau().end());
  for (int k = 0; k < n; ++k) {
    for (const FreeBody& body : bodies)
      apply_drag(body.inertia, world.q().data() + body.iq, world.v().data() + body.iv, tau.data() + body.iv);
    world.set_tau(tau);
    world.step();
  }
  for (const FreeBody& body : bodies) std::fill_n(tau.data() + body.iv, 6, 0.0);
  world.set_tau(tau);
}

std::vector<double> approach(const Model& model, FrameId frame, const Transform<double>& X_WF,
                             std::span<const double> start) {
  std::vector<double> q(start.begin(), start.end());
  if (model.frame(frame).body.value() == 0) return q;
  const Tree<double> tree(model);
  const ParamsStorage<double> params(model);
  Workspace<double> ws(tree);
  improve_ik(tree, params, IkChain(model, frame), panda_gym_ik(), X_WF, q.data(), ws);
  return q;
}

}  // namespace manyhands
