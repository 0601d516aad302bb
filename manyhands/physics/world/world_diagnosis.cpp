// World: what commonly goes wrong with a scene.
#include <algorithm>

#include "manyhands/physics/dynamics/rnea.h"
#include "manyhands/physics/world/world_impl.h"
#include "manyhands/physics/world/world_text.h"

namespace manyhands {

namespace {

using internal::short_text;

constexpr double kFalling = 1.0;      // [m/s] downwards: what falls for a tenth of a second
constexpr double kSaturated = 0.999;  // share of its largest force that a motor gives when it can no more
constexpr double kBeyond = 1e-6;      // [rad or m] by which a target lies beyond a limit
constexpr std::size_t kNamed = 3;     // parts in a sentence

void add_if_any(const char* kind, std::vector<std::string> parts, const std::string& text,
                std::vector<Finding>& found) {
  if (parts.empty()) return;
  const std::string subject = internal::list_of(parts, kNamed);
  found.push_back({kind, std::move(parts), subject + text});
}

/// The body on the world that carries it.
BodyId root_of(const Model& model, BodyId body) {
  while (body.value() > 0 && model.body(body).parent.value() > 0) body = model.body(body).parent;
  return body;
}

bool collides(const Model& model, LinkId link) {
  return std::ranges::any_of(model.geoms_of(link),
                             [&](GeomId id) { return model.geoms()[id.index()].role == GeomRole::kCollision; });
}

std::vector<std::uint8_t> trees_that_collide(const Model& model) {
  std::vector<std::uint8_t> does(static_cast<std::size_t>(model.num_bodies()), 0);
  for (std::size_t i = 0; i < model.links().size(); ++i) {
    if (collides(model, LinkId(i))) does[root_of(model, model.link(LinkId(i)).body).index()] = 1;
  }
  return does;
}

/// Free bodies that nothing can stop, and those that nothing stops.
void find_falling(const World& world, const WorldCore& now, std::vector<Finding>& found) {
  const Model& model = *now.model;
  const Vec3<double> gravity = world.gravity();
  const double g = norm(gravity);
  std::vector<std::string> floating, shapeless, falling, rising;
  const std::vector<std::uint8_t> does_collide = trees_that_collide(model);
  for (int b = 1; b < model.num_bodies(); ++b) {
    const Body& body = model.body(BodyId(b));
    if (body.type != JointType::kFloating || body.parent.value() > 0) continue;
    const LinkId link = model.joint(body.joint).child;
    const std::string& name = model.link(link).name;
    if (!(g > 0)) {
      floating.push_back(name);
    } else if (does_collide[static_cast<std::size_t>(b)] == 0) {
      shapeless.push_back(name);
    } else if (dot(world.link_velocity(link).v, gravity) > kFalling * g) {
      const auto hits = world.ray_cast_all(world.link_pose(link).p, gravity, std::numeric_limits<double>::infinity());
      const bool is_above = std::ranges::any_of(
          hits, [&](const WorldRayHit& hit) { return root_of(model, model.link(hit.link).body) != BodyId(b); });
      if (!is_above) (gravity.z > 0 ? rising : falling).push_back(name);
    }
  }
  add_if_any("gravity", floating, ": nothing falls, gravity is zero; set it to (0, 0, -9.81)", found);
  add_if_any("gravity", rising, ": it falls upwards, for gravity points up; set it to (0, 0, -9.81)", found);
  add_if_any("no_shape", shapeless, ": no colliding shape, so it falls through everything; add one", found);
  add_if_any("no_ground", falling, ": it falls, and nothing lies below; add a plane, or look whether it began under it",
             found);
}

/// What it takes to hold still, of each dof [N m or N], contacts and couplings aside.
std::vector<double> holding_forces(const WorldCore& now) {
  const std::vector<double> rest(now.nv(), 0.0);
  std::vector<double> forces(now.nv());
  Workspace<double> ws(now.system.tree);
  rnea(now.system.tree, now.params, now.state.q(), rest.data(), rest.data(), forces.data(), ws);
  return forces;
}

void find_motors(const WorldCore& now, double h, std::vector<Finding>& found) {
  const Model& model = *now.model;
  const std::vector<double> needed = holding_forces(now);
  for (int b = 1; b < model.num_bodies(); ++b) {
    const Body& body = model.body(BodyId(b));
    const auto i = static_cast<std::size_t>(body.iv);
    if (body.nv != 1 || !(now.params.motor_max_force[i] > 0)) continue;
    const std::string& name = model.joint(body.joint).name;
    const std::string unit = body.type == JointType::kPrismatic ? " N" : " N m";
    const double most = now.params.motor_max_force[i], given = std::abs(now.state.joint_impulse()[i]) / h;
    if (now.has_stepped && given >= kSaturated * most && std::abs(needed[i]) > most) {
      found.push_back({"weak_motor",
                       {name},
                       "'" + name + "': its motor gives all that it may, " + short_text(most) + unit +
                           "; to hold still takes " + short_text(std::abs(needed[i])) + unit +
                           ": give it a larger max_force"});
    }
    const double target = now.state.target_q()[i], lower = now.params.lower[i], upper = now.params.upper[i];
    if (now.params.motor_kp[i] > 0 && (target < lower - kBeyond || target > upper + kBeyond)) {
      found.push_back({"target_beyond_limit",
                       {name},
                       "'" + name + "': its motor is to go to " + short_text(target) + ", and the joint goes from " +
                           short_text(lower) + " to " + short_text(upper)});
    }
  }
}

}  // namespace

std::vector<Finding> World::diagnose() const {
  const WorldCore& now = core();
  std::vector<Finding> found;
  if (time() == 0) {
    found.push_back({"no_step", {}, "no step has been taken: motors, forces and gravity act in step()"});
  }
  find_falling(*this, now, found);
  find_motors(now, time_step_, found);
  return found;
}

}  // namespace manyhands
