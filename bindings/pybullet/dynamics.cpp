// Masses, materials, kinematics.
#include <cmath>

#include "bindings/pybullet/arguments.h"

namespace manyhands::pybullet {

namespace {

PyObject* change_dynamics(Client& client, const Arguments& a) {
  bullet::DynamicsChange change;
  const auto take = [&](std::size_t i, std::optional<double>& to) {
    if (!a.has(i)) return;
    const double x = a.number(i);
    if (std::isnan(x)) throw Error("changeDynamics: a number is nan; nothing was changed");
    if (x >= 0) to = x;
  };
  take(2, change.mass);
  take(3, change.lateral_friction);
  take(4, change.spinning_friction);
  take(5, change.rolling_friction);
  take(6, change.restitution);
  take(7, change.linear_damping);
  take(8, change.angular_damping);
  take(9, change.contact_stiffness);
  take(10, change.contact_damping);
  if (a.integer(11, -1) >= 0) change.friction_anchor = a.integer(11) != 0;
  change.inertia = a.optional_vec3(12, "localInertiaDiagonal needs 3 numbers.");
  take(13, change.collision_margin);
  change.collision_margin.reset();  // ccdSweptSphereRadius: nothing passes through anything here
  if (a.integer(15, -1) >= 0) change.activation_state = a.integer(15);
  take(16, change.joint_damping);
  if (a.has(17)) (void)a.vec3(17, "anisotropicFriction needs 3 numbers.");
  take(18, change.max_joint_velocity);
  take(19, change.collision_margin);
  if (a.has(20) && a.has(21)) change.limits = {a.number(20), a.number(21)};
  take(22, change.joint_limit_force);
  client.change_dynamics(a.integer(0), a.integer(1), change);
  return none();
}

constexpr Function kChangeDynamics{
    "changeDynamics",
    "bodyUniqueId, linkIndex | mass=-1, lateralFriction=-1, spinningFriction=-1, rollingFriction=-1, restitution=-1, "
    "linearDamping=-1, angularDamping=-1, contactStiffness=-1, contactDamping=-1, frictionAnchor=-1, "
    "localInertiaDiagonal=None, ccdSweptSphereRadius=-1, contactProcessingThreshold=-1, activationState=-1, "
    "jointDamping=-1, anisotropicFriction=None, maxJointVelocity=-1, collisionMargin=-1, jointLowerLimit=None, "
    "jointUpperLimit=None, jointLimitForce=-1, sleepThreshold=-1",
    "Changes a link's mass and material, its joint's damping and limits, and the body's damping. Without effect here: "
    "frictionAnchor (contacts hold by themselves), ccdSweptSphereRadius, contactProcessingThreshold, activationState "
    "and sleepThreshold (nothing sleeps), collisionMargin (shapes have none; kept to be read back).",
    change_dynamics};

PyObject* dynamics_info(Client& client, const Arguments& a) {
  const bullet::DynamicsReading d = client.dynamics(a.integer(0), a.integer(1));
  return tuple(of(d.mass), of(d.lateral_friction), of(d.inertia), of(d.X_LI.p), of(d.X_LI.R), of(d.restitution),
               of(d.rolling_friction), of(d.spinning_friction), of(d.contact_damping), of(d.contact_stiffness),
               of(d.body_type), of(d.margin));
}

constexpr Function kDynamicsInfo{
    "getDynamicsInfo", "bodyUniqueId, linkIndex",
    "Mass, lateral friction, inertia (3), centre-of-mass frame in the link's, restitution, rolling and spinning "
    "friction, contact damping and stiffness (-1: none), type of body (2), collision margin.",
    dynamics_info};

}  // namespace

void add_dynamics(Methods& methods) {
  add_to<kChangeDynamics>(methods);
  add_to<kDynamicsInfo>(methods);
}

namespace {

PyObject* inverse_kinematics(Client& client, const Arguments& a) {
  bullet::IkRequest request{.link = a.integer(1)};
  request.position = a.vec3(2, "calculateInverseKinematics couldn't extract position vector3");
  if (a.has(3)) request.orientation = a.quaternion(3, "calculateInverseKinematics couldn't extract orientation");
  request.lower = a.numbers(4);
  request.upper = a.numbers(5);
  request.range = a.numbers(6);
  request.rest = a.numbers(7);
  request.damping = a.numbers(8);
  request.start = a.numbers(10);
  request.max_iterations = a.integer(11, 20);
  request.threshold = a.number(12, 1e-4);
  return of(std::span<const double>(client.inverse_kinematics(a.integer(0), request)));
}

constexpr Function kIk{
    "calculateInverseKinematics",
    "bodyUniqueId, endEffectorLinkIndex, targetPosition | targetOrientation=None, lowerLimits=None, upperLimits=None, "
    "jointRanges=None, restPoses=None, jointDamping=None, solver=0, currentPositions=None, maxNumIterations=20, "
    "residualThreshold=0.0001",
    "Positions of all joints that move which bring a link's frame to a position in the world, and its axes to an "
    "orientation. From the present state, by damped least squares; with limits, ranges and rest poses of all joints "
    "it stays near these. manyhands.inverse_kinematics keeps limits and says whether it succeeded.",
    inverse_kinematics};

PyObject* rows(std::span<const double> numbers, std::size_t columns) {
  const std::size_t n = columns == 0 ? 0 : numbers.size() / columns;
  PyObject* const all = PyTuple_New(static_cast<Py_ssize_t>(n));
  for (std::size_t i = 0; i < n; ++i) {
    PyTuple_SetItem(all, static_cast<Py_ssize_t>(i), of(numbers.subspan(i * columns, columns)));
  }
  return all;
}

constexpr Function kJacobian{
    "calculateJacobian", "bodyUniqueId, linkIndex, localPosition, objPositions, objVelocities, objAccelerations",
    "Linear and angular Jacobian (3 rows each) of a point of a link at objPositions, in the axes of the base; a free "
    "base has six columns, angular first, before those of the joints.",
    [](Client& client, const Arguments& a) -> PyObject* {
      const std::vector<double> q = a.numbers(3), v = a.numbers(4), acc = a.numbers(5);
      if (v.size() != q.size() || acc.size() != q.size()) {
        throw Error(
            "calculateJacobian: objPositions, objVelocities and objAccelerations need one number for each joint "
            "that moves");
      }
      const std::vector<double> J =
          client.jacobian(a.integer(0), a.integer(1), a.vec3(2, "localPosition needs 3 numbers."), q);
      const std::size_t half = J.size() / 2;
      return tuple(rows(std::span(J).first(half), half / 3), rows(std::span(J).subspan(half), half / 3));
    }};

constexpr int kPadded = 1;  // of flags

constexpr Function kMassMatrix{
    "calculateMassMatrix", "bodyUniqueId, objPositions | flags=0",
    "The mass matrix at objPositions, as rows. With flags=1 objPositions begin with the pose of a free base, and rows "
    "are as many as they: the base's and those of spherical joints end with one that stands for nothing.",
    [](Client& client, const Arguments& a) -> PyObject* {
      const std::vector<double> M = client.mass_matrix(a.integer(0), a.numbers(1), (a.integer(2, 0) & kPadded) != 0);
      std::size_t n = 0;
      while (n * n < M.size()) ++n;
      return rows(M, n);
    }};

constexpr Function kInverseDynamics{
    "calculateInverseDynamics", "bodyUniqueId, objPositions, objVelocities, objAccelerations | flags=0",
    "Joint forces that lead to these accelerations, against gravity; without damping and motors. With flags=1 all "
    "lists are as long as objPositions, see calculateMassMatrix.",
    [](Client& client, const Arguments& a) -> PyObject* {
      return of(std::span<const double>(client.inverse_dynamics(a.integer(0), a.numbers(1), a.numbers(2), a.numbers(3),
                                                                (a.integer(4, 0) & kPadded) != 0)));
    }};

}  // namespace

void add_kinematics(Methods& methods) {
  add_to<kIk>(methods);
  add_to<kJacobian>(methods);
  add_to<kMassMatrix>(methods);
  add_to<kInverseDynamics>(methods);
}

namespace {

PyObject* create_constraint(Client& client, const Arguments& a) {
  bullet::UserConstraint c{.parent = a.integer(0),
                           .parent_link = a.integer(1),
                           .child = a.integer(2),
                           .child_link = a.integer(3),
                           .type = static_cast<bullet::JointCode>(a.integer(4)),
                           .axis = a.vec3(5, "jointAxis needs 3 numbers.")};
  c.X_parent = {a.rotation(8, "parentFrameOrientation needs 4 numbers."),
                a.vec3(6, "parentFramePosition needs 3 numbers.")};
  c.X_child = {a.rotation(9, "childFrameOrientation needs 4 numbers."),
               a.vec3(7, "childFramePosition needs 3 numbers.")};
  return of(client.create_constraint(c));
}

constexpr Function kCreateConstraint{
    "createConstraint",
    "parentBodyUniqueId, parentLinkIndex, childBodyUniqueId, childLinkIndex, jointType, jointAxis, "
    "parentFramePosition, childFramePosition | parentFrameOrientation=None, childFrameOrientation=None",
    "Joins two links, or a link and the world (child -1): JOINT_FIXED, JOINT_POINT2POINT, JOINT_PRISMATIC or "
    "JOINT_GEAR. Frames are given in centre-of-mass frames. Returns an id.",
    create_constraint};

PyObject* change_constraint(Client& client, const Arguments& a) {
  bullet::ConstraintChange change;
  change.child_pivot = a.optional_vec3(1, "jointChildPivot needs 3 numbers.");
  if (a.has(2)) change.child_orientation = a.quaternion(2, "jointChildFrameOrientation needs 4 numbers.");
  change.max_force = a.optional(3);
  change.gear_ratio = a.optional(4);
  if (a.has(5)) change.gear_aux_link = a.integer(5);
  change.relative_target = a.optional(6);
  change.erp = a.optional(7);
  client.change_constraint(a.integer(0), change);
  return none();
}

constexpr Function kChangeConstraint{
    "changeConstraint",
    "userConstraintUniqueId | jointChildPivot=None, jointChildFrameOrientation=None, maxForce=None, gearRatio=None, "
    "gearAuxLink=None, relativePositionTarget=None, erp=None",
    "Moves a constraint's child frame, limits its force [N], or sets a gear's ratio and target.", change_constraint};

constexpr Function kRemoveConstraint{"removeConstraint", "userConstraintUniqueId", "Takes a constraint away.",
                                     [](Client& client, const Arguments& a) -> PyObject* {
                                       client.remove_constraint(a.integer(0));
                                       return none();
                                     }};

PyObject* constraint_info(Client& client, const Arguments& a) {
  const bullet::UserConstraint& c = client.constraint(a.integer(0));
  return tuple(of(c.parent), of(c.parent_link), of(c.child), of(c.child_link), of(static_cast<int>(c.type)), of(c.axis),
               of(c.X_parent.p), of(c.X_child.p), of(c.X_parent.R), of(c.X_child.R), of(c.max_force),
               of(c.has_gear_ratio ? c.gear_ratio : 0.0), of(std::max(c.gear_aux_link, 0)), of(c.relative_target),
               of(c.erp));
}

constexpr Function kConstraintInfo{
    "getConstraintInfo", "constraintUniqueId",
    "Bodies and links of parent and child, type, axis, positions and orientations of both frames, largest force, gear "
    "ratio, auxiliary link, target and error reduction.",
    constraint_info};

constexpr Function kNumConstraints{
    "getNumConstraints", "", "How many constraints there are.",
    [](Client& client, const Arguments&) -> PyObject* { return of(static_cast<int>(client.constraint_ids().size())); }};

constexpr Function kConstraintId{"getConstraintUniqueId", "serialIndex", "The id of a constraint; -1 beyond the last.",
                                 [](Client& client, const Arguments& a) -> PyObject* {
                                   const std::span<const int> ids = client.constraint_ids();
                                   const int i = a.integer(0);
                                   const bool is_there = i >= 0 && i < static_cast<int>(ids.size());
                                   return of(is_there ? ids[static_cast<std::size_t>(i)] : -1);
                                 }};

}  // namespace

void add_constraints(Methods& methods) {
  add_to<kCreateConstraint>(methods);
  add_to<kChangeConstraint>(methods);
  add_to<kRemoveConstraint>(methods);
  add_to<kConstraintInfo>(methods);
  add_to<kNumConstraints>(methods);
  add_to<kConstraintId>(methods);
}

}  // namespace manyhands::pybullet
