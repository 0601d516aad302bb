// Where bodies, links and joints are, and how they move.
#include "bindings/pybullet/arguments.h"

namespace manyhands::pybullet {

namespace {

constexpr Function kBasePose{"getBasePositionAndOrientation", "bodyUniqueId",
                             "Position [m] and quaternion xyzw of the base's centre-of-mass frame in the world.",
                             [](Client& client, const Arguments& a) -> PyObject* {
                               const Transform<double> X = client.base_pose(a.integer(0));
                               return tuple(of(X.p), of(X.R));
                             }};

constexpr Function kBaseVelocity{"getBaseVelocity", "bodyUniqueId",
                                 "Linear [m/s] and angular [rad/s] velocity of the base's centre of mass, world axes.",
                                 [](Client& client, const Arguments& a) -> PyObject* {
                                   const Motion<double> V = client.base_velocity(a.integer(0));
                                   return tuple(of(V.v), of(V.w));
                                 }};

constexpr Function kResetBase{
    "resetBasePositionAndOrientation", "bodyUniqueId, posObj, ornObj",
    "Puts the base's centre-of-mass frame somewhere, at rest.", [](Client& client, const Arguments& a) -> PyObject* {
      const Vec3<double> p = a.vec3(1, "position needs a 3 coordinates [x,y,z].");
      client.reset_base_pose(a.integer(0), {a.rotation(2, "orientation needs a 4 coordinates [x,y,z,w]."), p});
      return none();
    }};

constexpr Function kResetVelocity{
    "resetBaseVelocity", "objectUniqueId | linearVelocity=None, angularVelocity=None",
    "Sets the velocity of the base's centre of mass, world axes; what is not given stays.",
    [](Client& client, const Arguments& a) -> PyObject* {
      if (!a.has(1) && !a.has(2)) throw Error("expected at least linearVelocity and/or angularVelocity.");
      client.reset_base_velocity(a.integer(0), a.optional_vec3(1, "linearVelocity needs 3 numbers."),
                                 a.optional_vec3(2, "angularVelocity needs 3 numbers."));
      return none();
    }};

PyObject* reaction_of(const bullet::JointReading& r) { return of(std::span<const double>(r.reaction)); }

PyObject* reading_of(const bullet::JointReading& r) {
  const auto first = [](const std::vector<double>& numbers) { return of(numbers.size() == 1 ? numbers[0] : 0.0); };
  return tuple(first(r.q), first(r.v), reaction_of(r), first(r.motor));
}

PyObject* multi_dof_of(const bullet::JointReading& r) {
  return tuple(of(std::span<const double>(r.q)), of(std::span<const double>(r.v)), reaction_of(r),
               of(std::span<const double>(r.motor)));
}

using Reading = PyObject* (*)(const bullet::JointReading&);

PyObject* joint_states(Client& client, const Arguments& a, Reading as) {
  const int id = a.integer(0);
  const std::vector<int> joints = a.integers(1);
  if (!client.has_body(id)) throw Error("getJointState failed.");
  for (const int joint : joints) client.require_joint(id, joint);
  if (joints.empty()) return none();
  return tuple_of(joints, [&](int joint) { return as(client.joint_state(id, joint)); });
}

constexpr Function kJointState{
    "getJointState", "bodyUniqueId, jointIndex",
    "Position, velocity, the six numbers of the joint's force sensor, and the motor's force.",
    [](Client& client, const Arguments& a) -> PyObject* {
      return reading_of(client.joint_state(a.integer(0), a.integer(1)));
    }};
constexpr Function kJointStates{
    "getJointStates", "bodyUniqueId, jointIndices", "A tuple of what getJointState gives; None without joints.",
    [](Client& client, const Arguments& a) -> PyObject* { return joint_states(client, a, reading_of); }};
constexpr Function kJointStateMultiDof{"getJointStateMultiDof", "bodyUniqueId, jointIndex",
                                       "As getJointState, with tuples for joints of several degrees of freedom.",
                                       [](Client& client, const Arguments& a) -> PyObject* {
                                         return multi_dof_of(client.joint_state(a.integer(0), a.integer(1)));
                                       }};
constexpr Function kJointStatesMultiDof{
    "getJointStatesMultiDof", "bodyUniqueId, jointIndex",
    "A tuple of what getJointStateMultiDof gives, of a list of joints.",
    [](Client& client, const Arguments& a) -> PyObject* { return joint_states(client, a, multi_dof_of); }};

constexpr Function kResetJoint{"resetJointState", "bodyUniqueId, jointIndex, targetValue | targetVelocity=0",
                               "Puts a joint at a position and velocity, whatever its motor and limits.",
                               [](Client& client, const Arguments& a) -> PyObject* {
                                 const double q = a.number(2), v = a.number(3, 0);
                                 client.reset_joint(a.integer(0), a.integer(1), std::span(&q, 1), std::span(&v, 1));
                                 return none();
                               }};

void reset_multi_dof(Client& client, int id, int joint, PyObject* q, PyObject* v) {
  const std::vector<double> position = one_or_more(q);
  std::vector<double> velocity(position.size() == 4 ? 3 : position.size(), 0.0);
  if (v != nullptr && v != Py_None) velocity = one_or_more(v);
  client.reset_joint(id, joint, position, velocity);
}

constexpr Function kResetMultiDof{"resetJointStateMultiDof",
                                  "bodyUniqueId, jointIndex, targetValue | targetVelocity=None",
                                  "As resetJointState, with lists: a quaternion and three rates of a spherical joint.",
                                  [](Client& client, const Arguments& a) -> PyObject* {
                                    reset_multi_dof(client, a.integer(0), a.integer(1), a.object(2), a.object(3));
                                    return none();
                                  }};

constexpr Function kResetMultiDofs{
    "resetJointStatesMultiDof", "bodyUniqueId, jointIndices, targetValues | targetVelocities=None",
    "The same for several joints.", [](Client& client, const Arguments& a) -> PyObject* {
      const std::vector<int> joints = a.integers(1);
      const auto n = static_cast<Py_ssize_t>(joints.size());
      const bool has_v = a.has(3);
      if (PySequence_Size(a.object(2)) != n || (has_v && PySequence_Size(a.object(3)) != n)) {
        PyErr_Clear();
        throw Error("number of target values should match the number of joint indices");
      }
      for (Py_ssize_t i = 0; i < n; ++i) {
        PyObject* const q = PySequence_GetItem(a.object(2), i);
        PyObject* const v = has_v ? PySequence_GetItem(a.object(3), i) : nullptr;
        reset_multi_dof(client, a.integer(0), joints[static_cast<std::size_t>(i)], q, v);
        Py_DecRef(q);
        if (v != nullptr) Py_DecRef(v);
      }
      return none();
    }};

PyObject* link_reading(Client& client, int id, int link, bool with_velocity) {
  if (link >= client.num_joints(id) && client.has_body(id)) return none();
  const bullet::LinkReading r = client.link_state(id, link);
  PyObject* const X_I = of(r.X_WI.R);
  if (!with_velocity) {
    return tuple(of(r.X_WI.p), X_I, of(r.X_LI.p), of(r.X_LI.R), of(r.X_WL.p), of(r.X_WL.R));
  }
  return tuple(of(r.X_WI.p), X_I, of(r.X_LI.p), of(r.X_LI.R), of(r.X_WL.p), of(r.X_WL.R), of(r.V.v), of(r.V.w));
}

constexpr Function kLinkState{
    "getLinkState", "bodyUniqueId, linkIndex | computeLinkVelocity=0, computeForwardKinematics=0",
    "World position and orientation of the link's centre of mass, that frame in the link's, world position and "
    "orientation of the link's frame; with computeLinkVelocity also linear and angular velocity of the centre of mass. "
    "Always of the present state.",
    [](Client& client, const Arguments& a) -> PyObject* {
      return link_reading(client, a.integer(0), a.integer(1), a.integer(2, 0) != 0);
    }};

constexpr Function kLinkStates{
    "getLinkStates", "bodyUniqueId, linkIndices | computeLinkVelocity=0, computeForwardKinematics=0",
    "A tuple of what getLinkState gives.", [](Client& client, const Arguments& a) -> PyObject* {
      const int id = a.integer(0);
      const bool with_velocity = a.integer(2, 0) != 0;
      const std::vector<int> links = a.integers(1);
      for (const int link : links) {
        if (link < 0 || link >= client.num_joints(id)) throw Error("getLinkStates failed; invalid linkIndex");
      }
      return tuple_of(links, [&](int link) { return link_reading(client, id, link, with_velocity); });
    }};

constexpr Function kSensor{"enableJointForceTorqueSensor", "bodyUniqueId, jointIndex | enableSensor=1",
                           "Makes getJointState give what the joint transmits to its child: force and torque.",
                           [](Client& client, const Arguments& a) -> PyObject* {
                             client.enable_force_torque_sensor(a.integer(0), a.integer(1), a.integer(2, 1) != 0);
                             return none();
                           }};

constexpr Function kAabb{"getAABB", "bodyUniqueId | linkIndex=-1",
                         "The corners of the box along the world's axes that holds a link's collision shapes.",
                         [](Client& client, const Arguments& a) -> PyObject* {
                           const bullet::Bounds b = client.bounds(a.integer(0), a.integer(1, -1));
                           return tuple(of(b.low), of(b.high));
                         }};

}  // namespace

void add_states(Methods& methods) {
  add_to<kBasePose>(methods);
  add_to<kBaseVelocity>(methods);
  add_to<kResetBase>(methods);
  add_to<kResetVelocity>(methods);
  add_to<kJointState>(methods);
  add_to<kJointStates>(methods);
  add_to<kJointStateMultiDof>(methods);
  add_to<kJointStatesMultiDof>(methods);
  add_to<kResetJoint>(methods);
  add_to<kResetMultiDof>(methods);
  add_to<kResetMultiDofs>(methods);
  add_to<kLinkState>(methods);
  add_to<kLinkStates>(methods);
  add_to<kSensor>(methods);
  add_to<kAabb>(methods);
}

}  // namespace manyhands::pybullet
