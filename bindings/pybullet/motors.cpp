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

/// The only number of a number or list of one.
double single(PyObject* object, double fallback) {
  if (object == nullptr || object == Py_None) return fallback;
  if (PySequence_Check(object) == 0) return number_of(object);
  const std::vector<double> numbers = numbers_of(object);
  if (numbers.size() == 1) return numbers[0];
  if (numbers.empty()) return fallback;
  throw Error("motors of spherical joints take no targets yet: expected one number");
}

void set_multi_dof(Client& client, int id, int joint, int mode, const std::array<PyObject*, 6>& o) {
  if (joint < 0 || joint >= client.num_joints(id)) throw Error("Joint index out-of-range.");
  MotorSetting s{.mode = mode_of(mode, bullet::kStablePd),
                 .target_q = single(o[0], 0),
                 .target_v = single(o[1], 0),
                 .force = single(o[2], 100000),
                 .kp = single(o[3], 0.1),
                 .kd = single(o[4], 1)};
  if (o[5] != nullptr && o[5] != Py_None) s.max_velocity = single(o[5], -1);
  client.set_motor(id, joint, s);
}

constexpr Function kSetMultiDof{
    "setJointMotorControlMultiDof",
    "bodyUniqueId, jointIndex, controlMode | targetPosition=None, targetVelocity=None, force=None, positionGain=0.1, "
    "velocityGain=1, maxVelocity=-1, damping=None",
    "As setJointMotorControl2, with lists. Spherical joints: their default motor, or force=[0, 0, 0] without targets.",
    [](Client& client, const Arguments& a) -> PyObject* {
      const int id = a.integer(0), joint = a.integer(1);
      const bool lists_force = a.has(5) && PySequence_Check(a.object(5)) != 0;
      const std::vector<double> force = lists_force ? numbers_of(a.object(5)) : std::vector<double>{};
      if (force.size() > 1 && joint >= 0 && joint < client.num_joints(id)) {
        client.set_motor(id, joint, {.mode = bullet::kVelocity, .force = force[0]});
        return none();
      }
      set_multi_dof(client, id, joint, a.integer(2),
                    {a.object(3), a.object(4), a.object(5), a.object(6), a.object(7), a.object(8)});
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
  add_to<kSetMotorLegacy>(methods);
  add_to<kForce>(methods);
  add_to<kTorque>(methods);
}

}  // namespace manyhands::pybullet
