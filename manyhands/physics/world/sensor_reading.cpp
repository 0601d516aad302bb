#include "manyhands/physics/world/sensor_reading.h"

#include "manyhands/physics/collision/queries/ray_cast.h"
#include "manyhands/physics/dynamics/actuation.h"

namespace manyhands {

namespace {

std::vector<double> listed(const Quat<double>& q) { return {q.x, q.y, q.z, q.w}; }

/// A frame on a link: its pose, and how it moves, in world axes.
struct MovingFrame {
  Transform<double> X_WF = Transform<double>::identity();
  Vec3<double> omega{}, velocity{};
};

MovingFrame frame_on(const WorldCore& core, LinkId id, const Transform<double>& X_LF) {
  if (!id.is_valid()) return {};
  const Link& link = core.model->link(id);
  const Workspace<double>& ws = core.placed();
  const Transform<double> X_BF = link.X_BL * X_LF;
  const Vec3<double> r = ws.R_WB[link.body.index()] * X_BF.p + ws.p_OB[link.body.index()];
  const Motion<double> V = at_point(ws.V[link.body.index()], r);
  return {frame_pose(link.body, X_BF, ws), V.w, V.v};
}

/// How far a ray along z of the frame, up to `far`, goes to a visual of a simple shape on another link.
double range_to_visuals(const WorldCore& core, const Sensor& sensor, const Transform<double>& X_WF, double far) {
  for (const Geom& geom : core.model->geoms()) {
    const bool is_simple = geom.shape.type <= ShapeType::kPlane;
    const bool is_shown = geom.role == GeomRole::kVisual && geom.rgba[3] > 0;
    if (!is_shown || !is_simple || geom.link == sensor.link) continue;
    const Link& link = core.model->link(geom.link);
    const Transform<double> X_WG = frame_pose(link.body, link.X_BL * geom.X_LG, core.placed());
    const ShapeView shape{.type = geom.shape.type, .size = geom.shape.size};
    if (const auto hit = ray_cast(shape, X_WG, X_WF.p, X_WF.R.z, far)) far = hit->distance;
  }
  return far;
}

/// The first geom along z of the frame, those of its own link left out; -1 if there is none [m].
double range(const WorldCore& core, const Sensor& sensor, const Transform<double>& X_WF) {
  const PlacedGeoms geoms(core.system.colliders, core.params, core.placed_geoms());
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    const bool is_there = geoms.radius(i) >= 0 && geoms.geom(i).link != sensor.link.index();
    if (!is_there) continue;
    const auto hit = ray_cast(geoms.shape(i), geoms.pose(i), X_WF.p, X_WF.R.z, nearest);
    if (hit) nearest = hit->distance;
  }
  nearest = range_to_visuals(core, sensor, X_WF, nearest);
  return is_finite(nearest) ? nearest : -1;
}

struct Subtree {
  Vec3<double> com{}, velocity{}, angular_momentum{};  ///< the last about com
};

Subtree subtree_at(const WorldCore& core, const Sensor& sensor) {
  const Workspace<double>& ws = core.placed();
  Force<double> momentum = Force<double>::zero();
  double mass = 0;
  Vec3<double> moment = Vec3<double>::zero();
  std::vector<LinkId> left{sensor.link};
  while (!left.empty()) {
    const LinkId id = left.back();
    left.pop_back();
    const std::span<const LinkId> children = core.model->children_of(id);
    left.insert(left.end(), children.begin(), children.end());
    const Link& link = core.model->link(id);
    const double m = core.extras.link_mass[id.index()];
    if (!(m > 0)) continue;
    const std::size_t b = link.body.index();
    const Transform<double> X_OL = Transform<double>{ws.R_WB[b], ws.p_OB[b]} * link.X_BL;
    const RigidInertia<double> I = transformed(X_OL, link.inertial.about_origin());
    const Force<double> own = (m / link.inertial.mass) * (I * ws.V[b]);
    momentum = momentum + Force<double>{own.n + cross(ws.p_WO[b], own.f), own.f};
    moment = fma(m, X_OL * link.inertial.com + ws.p_WO[b], moment);
    mass += m;
  }
  if (!(mass > 0)) return {.com = frame_on(core, sensor.link, sensor.X_LF).X_WF.p};
  const Vec3<double> com = (1 / mass) * moment;
  return {com, (1 / mass) * momentum.f, momentum.n - cross(com, momentum.f)};
}

/// q and v of what actuator k drives, in the present state.
std::pair<double, double> driven_by(const WorldCore& core, ActuatorId k) {
  const TreeActuator<double>& actuator = core.system.tree.actuators[k.index()];
  if (actuator.law < core.nv()) return {core.state.q()[actuator.q], core.state.v()[actuator.law]};
  const Workspace<double>& ws = core.placed_lengths();
  return {ws.length[actuator.q], ws.length_rate[actuator.q]};
}

/// Of frames, against their references.
std::vector<double> read_frame(const WorldCore& core, const Sensor& sensor) {
  const MovingFrame F = frame_on(core, sensor.link, sensor.X_LF), R = frame_on(core, sensor.reference, sensor.X_LR);
  const auto in_R = [&](const Vec3<double>& a) { return listed(transpose_times(R.X_WF.R, a)); };
  const Vec3<double> way = F.X_WF.p - R.X_WF.p;
  switch (sensor.type) {
    case SensorType::kFramePosition:
      return in_R(way);
    case SensorType::kFrameQuaternion:
      return listed(to_quat(transpose(R.X_WF.R) * F.X_WF.R));
    case SensorType::kFrameXAxis:
      return in_R(F.X_WF.R.x);
    case SensorType::kFrameYAxis:
      return in_R(F.X_WF.R.y);
    case SensorType::kFrameZAxis:
      return in_R(F.X_WF.R.z);
    case SensorType::kFrameLinearVelocity:
      return in_R(F.velocity - R.velocity - cross(R.omega, way));
    case SensorType::kFrameAngularVelocity:
      return in_R(F.omega - R.omega);
    case SensorType::kVelocimeter:
      return listed(transpose_times(F.X_WF.R, F.velocity));
    case SensorType::kGyro:
      return listed(transpose_times(F.X_WF.R, F.omega));
    default:
      return {range(core, sensor, F.X_WF)};
  }
}

/// Numbers of a joint.
std::vector<double> read_joint(const WorldCore& core, const Sensor& sensor) {
  const Joint& joint = core.model->joint(sensor.joint);
  const double* const q = core.state.q() + joint.iq;
  const double* const v = core.state.v() + joint.iv;
  switch (sensor.type) {
    case SensorType::kJointPosition:
      return {q[0]};
    case SensorType::kJointVelocity:
      return {v[0]};
    case SensorType::kBallQuaternion:
      return {q[0], q[1], q[2], q[3]};
    default:
      return listed(transpose_times(to_matrix(Quat<double>{q[0], q[1], q[2], q[3]}), Vec3<double>{v[0], v[1], v[2]}));
  }
}

}  // namespace

bool tells_of_step(SensorType type) {
  switch (type) {
    case SensorType::kActuatorForce:
    case SensorType::kFrameLinearAcceleration:
    case SensorType::kFrameAngularAcceleration:
    case SensorType::kAccelerometer:
    case SensorType::kForce:
    case SensorType::kTorque:
    case SensorType::kTouch:
      return true;
    default:
      return false;
  }
}

std::vector<double> read_state(const WorldCore& core, const Sensor& sensor, double time) {
  switch (sensor.type) {
    case SensorType::kJointPosition:
    case SensorType::kJointVelocity:
    case SensorType::kBallQuaternion:
    case SensorType::kBallAngularVelocity:
      return read_joint(core, sensor);
    case SensorType::kTendonPosition:
      return {core.placed_lengths().length[sensor.tendon.index()]};
    case SensorType::kTendonVelocity:
      return {core.placed_lengths().length_rate[sensor.tendon.index()]};
    case SensorType::kActuatorPosition:
      return {core.params.gear[sensor.actuator.index()] * driven_by(core, sensor.actuator).first};
    case SensorType::kActuatorVelocity:
      return {core.params.gear[sensor.actuator.index()] * driven_by(core, sensor.actuator).second};
    case SensorType::kSubtreeCenterOfMass:
      return listed(subtree_at(core, sensor).com);
    case SensorType::kSubtreeLinearVelocity:
      return listed(subtree_at(core, sensor).velocity);
    case SensorType::kSubtreeAngularMomentum:
      return listed(subtree_at(core, sensor).angular_momentum);
    case SensorType::kClock:
      return {time};
    default:
      return read_frame(core, sensor);
  }
}

double actuator_force(const WorldCore& core, std::size_t k, double h) {
  const Tree<double>& tree = core.system.tree;
  const TreeActuator<double>& actuator = tree.actuators[k];
  State<double> before;
  std::vector<double> numbers_before = core.before, none;
  before.place(core.state_layout(), numbers_before.data(), none);
  const double gear = core.params.gear[k], bound = core.params.drive_max_force[k], middle = actuator.middle_force;
  const double ctrl = command(tree, h, before, k);
  double force = gear * ctrl;
  if (is_drive(actuator.type)) {
    const Workspace<double>& ws = core.step.dynamics;
    const bool is_dof = actuator.law < core.nv();
    const double q = is_dof ? before.q()[actuator.q] : ws.length[actuator.q];
    const double v = is_dof ? before.v()[actuator.law] : ws.length_rate[actuator.q];
    const double dv = is_dof ? core.state.dv()[actuator.law]
                             : along_length(tree, ws, actuator.q, static_cast<const State<double>&>(core.state).dv());
    const DriveLaw<double> law = drive_law(actuator, core.params, k, ctrl, q, v);
    force = gear * (law.pull - fma(h, law.stiffness, law.damping) * gear * (v + dv));
  }
  return clamp(force, middle - bound, middle + bound) / gear;
}

void place_last_step(const WorldCore& core, double h) {
  std::vector<double> a(core.nv());
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = core.state.dv()[i] / h;
  core.is_placed = false;
  internal::newton_euler_pass(core.system.tree, core.params, core.q_before(), core.v_before(), a.data(), core.scratch);
}

Motion<double> acceleration_of(const WorldCore& core, const Sensor& sensor) {
  const Link& link = core.model->link(sensor.link);
  const std::size_t b = link.body.index();
  const Vec3<double> r = core.scratch.R_WB[b] * (link.X_BL * sensor.X_LF).p + core.scratch.p_OB[b];
  return {b == 0 ? Vec3<double>::zero() : core.scratch.A[b].w, internal::motion_at(core.scratch, b, r).acceleration};
}

Transform<double> pose_before(const WorldCore& core, const Sensor& sensor) {
  const Link& link = core.model->link(sensor.link);
  return frame_pose(link.body, link.X_BL * sensor.X_LF, core.step.dynamics);
}

void cut_off(const Sensor& sensor, std::vector<double>& values) {
  const bool is_direction = sensor.type == SensorType::kFrameQuaternion || sensor.type == SensorType::kFrameXAxis ||
                            sensor.type == SensorType::kFrameYAxis || sensor.type == SensorType::kFrameZAxis ||
                            sensor.type == SensorType::kBallQuaternion;
  if (!(sensor.cutoff > 0) || is_direction) return;
  for (double& x : values) x = clamp(x, -sensor.cutoff, sensor.cutoff);
}

}  // namespace manyhands
