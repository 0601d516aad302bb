// Motors and external forces.
#include <memory>

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
  client.require_joint(id, joint);
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

/// What a joint is told to do, of any number of dofs; empty lists are unset.
struct MultiDof {
  std::vector<double> target_q{}, target_v{}, force{}, kp{}, kd{}, max_velocity{};
};

/// Programs also give joints of one degree of freedom what spherical ones take; as in PyBullet the first number counts.
double single(const std::vector<double>& numbers, double fallback) { return numbers.empty() ? fallback : numbers[0]; }

Vec3<double> triple(const std::vector<double>& numbers, double fallback) {
  if (numbers.empty()) return {fallback, fallback, fallback};
  if (numbers.size() == 1) return {numbers[0], numbers[0], numbers[0]};
  if (numbers.size() != 3)
    throw Error("a spherical joint takes three numbers, and a quaternion as its position; got " +
                std::to_string(numbers.size()));
  return {numbers[0], numbers[1], numbers[2]};
}

void set_multi_dof(Client& client, int id, int joint, int mode, const MultiDof& given) {
  client.require_joint(id, joint);
  const bullet::ControlMode control = mode_of(mode, bullet::kStablePd);
  if (control == bullet::kVelocity || control == bullet::kPd) throw Error("Illegal control mode.");
  const bool torque = control == bullet::kTorque;
  if (client.is_ball(id, joint)) {
    bullet::BallSetting s{.mode = control,
                          .target_v = triple(given.target_v, 0),
                          .force = triple(given.force, torque ? 0 : 100000),
                          .kp = single(given.kp, 0.1),
                          .kd = single(given.kd, 1)};
    const std::vector<double>& q = given.target_q;
    if (q.size() == 4) s.target_q = normalized(Quat<double>{q[0], q[1], q[2], q[3]});
    client.set_ball_motor(id, joint, s);
    return;
  }
  MotorSetting s{.mode = control,
                 .target_q = single(given.target_q, 0),
                 .target_v = single(given.target_v, 0),
                 .force = single(given.force, torque ? 0 : 100000),
                 .kp = single(given.kp, 0.1),
                 .kd = single(given.kd, 1)};
  if (!given.max_velocity.empty()) s.max_velocity = given.max_velocity[0];
  client.set_motor(id, joint, s);
}

constexpr Function kSetMultiDof{
    "setJointMotorControlMultiDof",
    "bodyUniqueId, jointIndex, controlMode | targetPosition=None, targetVelocity=None, force=None, positionGain=0.1, "
    "velocityGain=1, maxVelocity=-1, damping=None",
    "As setJointMotorControl2, with lists: of a spherical joint a quaternion, three velocities and three forces. Also "
    "takes STABLE_PD_CONTROL, a PD that counts with the position and velocity after the step.",
    [](Client& client, const Arguments& a) -> PyObject* {
      MultiDof given{.target_q = one_or_more(a.object(3)),
                     .target_v = one_or_more(a.object(4)),
                     .force = one_or_more(a.object(5)),
                     .kp = one_or_more(a.object(6)),
                     .kd = one_or_more(a.object(7)),
                     .max_velocity = one_or_more(a.object(8))};
      set_multi_dof(client, a.integer(0), a.integer(1), a.integer(2), given);
      return none();
    }};

/// Item k of a list of one item for each joint; nothing where there is no list.
std::vector<double> item(PyObject* list, Py_ssize_t count, Py_ssize_t k, const char* what) {
  if (list == nullptr || list == Py_None) return {};
  if (PySequence_Size(list) != count) {
    PyErr_Clear();
    throw Error(std::string("setJointMotorControlMultiDofArray: ") + what + " has not as many items as jointIndices");
  }
  const std::unique_ptr<PyObject, decltype(&Py_DecRef)> found(PySequence_GetItem(list, k), &Py_DecRef);
  if (found == nullptr) throw PythonError();
  return one_or_more(found.get());
}

constexpr Function kSetMultiDofs{
    "setJointMotorControlMultiDofArray",
    "bodyUniqueId, jointIndices, controlMode | targetPositions=None, targetVelocities=None, forces=None, "
    "positionGains=None, velocityGains=None, maxVelocities=None",
    "As setJointMotorControlMultiDof, for several joints: lists of one length.",
    [](Client& client, const Arguments& a) -> PyObject* {
      const std::vector<int> joints = a.integers(1);
      const auto n = static_cast<Py_ssize_t>(joints.size());
      std::vector<MultiDof> all;
      for (Py_ssize_t k = 0; k < n; ++k) {
        all.push_back({.target_q = item(a.object(3), n, k, "targetPositions"),
                       .target_v = item(a.object(4), n, k, "targetVelocities"),
                       .force = item(a.object(5), n, k, "forces"),
                       .kp = item(a.object(6), n, k, "positionGains"),
                       .kd = item(a.object(7), n, k, "velocityGains"),
                       .max_velocity = item(a.object(8), n, k, "maxVelocities")});
      }
      for (std::size_t k = 0; k < joints.size(); ++k) {
        set_multi_dof(client, a.integer(0), joints[k], a.integer(2), all[k]);
      }
      return none();
    }};

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
