// Motors and external forces.
#include "bindings/pybullet/arguments.h"

namespace manyhands::pybullet {

namespace {

using bullet::MotorSetting;

bullet::ControlMode mode_of(int mode, int last) {
  if (mode < 0 || mode > last) throw Error("Illegal control mode.");
  return static_cast<bullet::ControlMode>(mode);
}

PyObject* set_motor(Client& client, const Arguments& a) {
  const int id = a.integer(0), joint = a.integer(1), mode = a.integer(2);
  if (joint < 0 || joint >= client.num_joints(id)) throw Error("Joint index out-of-range.");
  MotorSetting s{.mode = mode_of(mode, bullet::kPd),
                 .target_q = a.number(3, 0),
                 .target_v = a.number(4, 0),
                 .force = a.number(5, 100000),
                 .kp = a.number(6, 0.1),
                 .kd = a.number(7, 1)};
  if (a.has(8)) s.max_velocity = a.number(8);
  client.set_motor(id, joint, s);
  return none();
}

constexpr Function kSetMotor{
    "setJointMotorControl2",
    "bodyUniqueId, jointIndex, controlMode | targetPosition=0, targetVelocity=0, force=100000, positionGain=0.1, "
    "velocityGain=1, maxVelocity=-1",
    "Commands a joint. POSITION_CONTROL and VELOCITY_CONTROL drive it by at most `force` [N m or N]; gains are the "
    "share "
    "of the error that one step removes. TORQUE_CONTROL adds `force` in the next step. PD_CONTROL: gains in N m/rad.",
    set_motor};

/// Puts the numbers of a list, one for each joint, into a field of the settings; unset lists leave it.
void take_list(const Arguments& a, std::size_t i, double MotorSetting::* field, std::span<MotorSetting> settings,
               const char* error) {
  if (!a.has(i)) return;
  const std::vector<double> numbers = a.numbers(i);
  if (numbers.size() != settings.size()) throw Error(error);
  for (std::size_t k = 0; k < numbers.size(); ++k) settings[k].*field = numbers[k];
}

PyObject* set_motors(Client& client, const Arguments& a) {
  const std::vector<int> joints = a.integers(1);
  if (joints.empty()) return none();
  const MotorSetting standard{.mode = mode_of(a.integer(2), bullet::kPd)};
  std::vector<MotorSetting> settings(joints.size(), standard);
  take_list(a, 3, &MotorSetting::target_q, settings,
            "number of target positions should match the number of joint indices");
  take_list(a, 4, &MotorSetting::target_v, settings,
            "number of target velocities should match the number of joint indices");
  take_list(a, 5, &MotorSetting::force, settings, "number of forces should match the joint indices");
  take_list(a, 6, &MotorSetting::kp, settings, "number of kps should match the joint indices");
  take_list(a, 7, &MotorSetting::kd, settings, "number of kds should match the number of joint indices");
  client.set_motors(a.integer(0), joints, settings);
  return none();
}

constexpr Function kSetMotors{
    "setJointMotorControlArray",
    "bodyUniqueId, jointIndices, controlMode | targetPositions=None, targetVelocities=None, forces=None, "
    "positionGains=None, velocityGains=None",
    "As setJointMotorControl2, for several joints: lists of one length.", set_motors};

/// The number, or the only one of a list.
double single(const std::vector<double>& numbers, double fallback, const char* what) {
  if (numbers.empty()) return fallback;
  if (numbers.size() == 1) return numbers[0];
  throw Error(std::string(what) + ": expected one number for a joint of one degree of freedom");
}

/// What setJointMotorControlMultiDof takes besides body and joint: empty where it was not given.
struct MultiDof {
  std::vector<double> position{}, velocity{}, force{};
  double kp = 0.1, kd = 1, max_velocity = -1;
};

/// A spherical joint turns to a quaternion with equal strength about all axes, or takes three torques.
MotorSetting round_setting(bullet::ControlMode mode, const MultiDof& m) {
  MotorSetting s{.mode = mode, .force = m.force.empty() ? 100000 : m.force[0], .kp = m.kp};
  if (mode == bullet::kTorque) {
    if (m.force.size() == 3) s.torque = {m.force[0], m.force[1], m.force[2]};
    return s;
  }
  if (m.position.size() == 4) s.target_r = Quat<double>{m.position[0], m.position[1], m.position[2], m.position[3]};
  s.mode = bullet::kVelocity;
  return s;
}

void set_multi_dof(Client& client, int id, int joint, int mode, const MultiDof& m) {
  if (joint < 0 || joint >= client.num_joints(id)) throw Error("Joint index out-of-range.");
  const bullet::ControlMode known = mode_of(mode, bullet::kStablePd);
  if (known == bullet::kVelocity || known == bullet::kPd) throw Error("Illegal control mode.");
  const JointType type = client.plan(id, "Joint index out-of-range.").link(joint).joint;
  if (type == JointType::kSpherical) return client.set_motor(id, joint, round_setting(known, m));
  if (type == JointType::kFixed) return;
  MotorSetting s{.mode = known,
                 .target_q = single(m.position, 0, "targetPosition"),
                 .target_v = single(m.velocity, 0, "targetVelocity"),
                 .force = m.force.empty() ? 100000 : m.force[0],
                 .kp = m.kp,
                 .kd = m.kd};
  if (m.max_velocity >= 0) s.max_velocity = m.max_velocity;
  client.set_motor(id, joint, s);
}

constexpr Function kSetMultiDof{
    "setJointMotorControlMultiDof",
    "bodyUniqueId, jointIndex, controlMode | targetPosition=None, targetVelocity=None, force=None, positionGain=0.1, "
    "velocityGain=1, maxVelocity=-1, damping=None",
    "As setJointMotorControl2, with lists. A spherical joint turns to a quaternion, by at most force[0] about each "
    "axis, "
    "or takes three torques; its velocity target and gain have no effect, as in Bullet.",
    [](Client& client, const Arguments& a) -> PyObject* {
      set_multi_dof(client, a.integer(0), a.integer(1), a.integer(2),
                    {.position = one_or_more(a.object(3)),
                     .velocity = one_or_more(a.object(4)),
                     .force = one_or_more(a.object(5)),
                     .kp = a.number(6, 0.1),
                     .kd = a.number(7, 1),
                     .max_velocity = a.number(8, -1)});
      return none();
    }};

/// Item k of each list that was given.
PyObject* set_multi_dofs(Client& client, const Arguments& a) {
  const std::vector<int> joints = a.integers(1);
  for (std::size_t i = 3; i <= 7; ++i) {
    if (a.has(i) && PySequence_Size(a.object(i)) != static_cast<Py_ssize_t>(joints.size())) {
      PyErr_Clear();
      throw Error("setJointMotorControlMultiDofArray: each list needs one entry for each joint");
    }
  }
  const auto list = [&](std::size_t i, std::size_t k) {
    if (!a.has(i)) return std::vector<double>{};
    PyObject* const item = PySequence_GetItem(a.object(i), static_cast<Py_ssize_t>(k));
    if (item == nullptr) throw PythonError{};
    try {
      std::vector<double> numbers = one_or_more(item);
      Py_DecRef(item);
      return numbers;
    } catch (...) {
      Py_DecRef(item);
      throw;
    }
  };
  std::vector<MultiDof> all;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    all.push_back({.position = list(3, k),
                   .velocity = list(4, k),
                   .force = list(5, k),
                   .kp = single(list(6, k), 0.1, "positionGains"),
                   .kd = single(list(7, k), 1, "velocityGains")});
  }
  for (std::size_t k = 0; k < joints.size(); ++k) {
    set_multi_dof(client, a.integer(0), joints[k], a.integer(2), all[k]);
  }
  return none();
}

constexpr Function kSetMultiDofs{
    "setJointMotorControlMultiDofArray",
    "bodyUniqueId, jointIndices, controlMode | targetPositions=None, targetVelocities=None, forces=None, "
    "positionGains=None, velocityGains=None, maxVelocities=None",
    "As setJointMotorControlMultiDof, for several joints: lists of one length.", set_multi_dofs};

PyObject* set_motor_legacy(Client& client, const Arguments& a) {
  const int id = a.integer(0), joint = a.integer(1);
  const bullet::ControlMode mode = mode_of(a.integer(2), bullet::kPd);
  const double target = a.number(3);
  MotorSetting s{.mode = mode, .force = a.number(4, 100000), .kp = a.number(5, 0.1), .kd = a.number(6, 1)};
  if (mode == bullet::kPosition) s.target_q = target;
  if (mode == bullet::kVelocity) s.target_v = target;
  if (mode == bullet::kTorque) s.force = target;
  client.set_motor(id, joint, s);
  return none();
}

constexpr Function kSetMotorLegacy{"setJointMotorControl",
                                   "bodyIndex, jointIndex, controlMode, targetValue | maxForce=100000, kp=0.1, kd=1",
                                   "The form before setJointMotorControl2.", set_motor_legacy};

bool in_link_frame(int flags) {
  constexpr int kLink = 1, kWorld = 2;
  if (flags != kLink && flags != kWorld) throw Error("flag has to be either WORLD_FRAME or LINK_FRAME");
  return flags == kLink;
}

constexpr Function kForce{"applyExternalForce", "objectUniqueId, linkIndex, forceObj, posObj, flags",
                          "A force [N] at a point, in the next step; both in the link's centre-of-mass frame "
                          "(LINK_FRAME) or in the world (WORLD_FRAME). Forces add up.",
                          [](Client& client, const Arguments& a) -> PyObject* {
                            client.apply_force(a.integer(0), a.integer(1), a.vec3(2, "force needs 3 numbers [x,y,z]."),
                                               a.vec3(3, "position needs 3 numbers [x,y,z]."),
                                               in_link_frame(a.integer(4)));
                            return none();
                          }};

constexpr Function kTorque{"applyExternalTorque", "objectUniqueId, linkIndex, torqueObj, flags",
                           "A torque [N m] in the next step.", [](Client& client, const Arguments& a) -> PyObject* {
                             client.apply_torque(a.integer(0), a.integer(1),
                                                 a.vec3(2, "torque needs 3 numbers [x,y,z]."),
                                                 in_link_frame(a.integer(3)));
                             return none();
                           }};

}  // namespace

void add_motors(Methods& methods) {
  add_to<kSetMotor>(methods);
  add_to<kSetMotors>(methods);
  add_to<kSetMultiDof>(methods);
  add_to<kSetMultiDofs>(methods);
  add_to<kSetMotorLegacy>(methods);
  add_to<kForce>(methods);
  add_to<kTorque>(methods);
}

}  // namespace manyhands::pybullet
