// Loading models, and what bodies and joints there are.
#include <filesystem>

#include "bindings/pybullet/arguments.h"
#include "bindings/pybullet/clients.h"
#include "manyhands/model/load_report.h"

namespace manyhands::pybullet {

namespace {

/// What loaders have to say goes to stdout, as PyBullet's warnings do.
void print_notes(Client& client) {
  for (const std::string& note : client.drain_notes()) PySys_FormatStdout("b3Warning: %s\n", note.c_str());
}

[[noreturn]] void fail_to_load(const std::string& reason, const char* error) {
  PySys_FormatStdout("b3Warning: %s\n", reason.c_str());
  throw Error(error);
}

/// The pose of arguments i (position) and i + 1 (quaternion), neither of which may be None.
Transform<double> pose(const Arguments& a, std::size_t i, const char* no_position, const char* no_orientation) {
  if (a.object(i) == Py_None) throw Error(no_position);
  if (a.object(i + 1) == Py_None) throw Error(no_orientation);
  return {a.rotation(i + 1, no_orientation), a.vec3(i, {0, 0, 0}, no_position)};
}

/// The legacy form: loadURDF(file, x, y, z [, qx, qy, qz, qw]).
bool is_legacy(const Arguments& a) {
  return a.has(1) && PyNumber_Check(a.object(1)) != 0 && PySequence_Check(a.object(1)) == 0;
}

PyObject* load_urdf(Client& client, const Arguments& a) {
  constexpr const char* kError = "Cannot load URDF file.";
  const std::string name = a.text(0), path = find_file(name);
  Transform<double> X = Transform<double>::identity();
  bullet::LoadOptions options;
  if (is_legacy(a)) {
    X.p = {a.number(1), a.number(2), a.number(3)};
    if (a.has(4)) X.R = to_matrix(normalized(Quat<double>{a.number(4), a.number(5), a.number(6), a.number(7)}));
  } else {
    X = pose(a, 1, "Cannot convert basePosition.", "Cannot convert baseOrientation.");
    options.maximal_coordinates = a.integer(3, -1) > 0;
    options.fixed_base = a.integer(4, 0) != 0;
    options.flags = a.integer(5, 0);
    const double scale = a.number(6, -1);
    if (scale > 0) options.scale = scale;
  }
  if (path.empty())
    fail_to_load("loadURDF: there is no file '" + name + "' here or in the additional search path", kError);
  try {
    const int id = client.load_urdf(path, X, options);
    print_notes(client);
    return of(id);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    fail_to_load(error.what(), kError);
  }
}

/// In the legacy form the eighth number is a quaternion's, and not the client.
constexpr FreeFunction kLoadUrdf{
    "loadURDF",
    "fileName | basePosition=[0, 0, 0], baseOrientation=[0, 0, 0, 1], useMaximalCoordinates=-1, useFixedBase=0, "
    "flags=0, globalScaling=-1",
    "Loads a robot or thing, whose base link comes to stand at basePosition [m], baseOrientation (xyzw), and returns "
    "its body id. Prints what is wrong and raises error if it cannot.",
    [](const Arguments& a) -> PyObject* {
      const ClientLock client(is_legacy(a) ? 0 : a.integer(7, 0));
      return load_urdf(*client, a);
    }};

using LoadAll = std::vector<int> (Client::*)(const std::filesystem::path&, const bullet::LoadOptions&);

PyObject* load_all(Client& client, LoadAll load, const std::string& name, int flags, const char* error) {
  const std::string path = find_file(name);
  if (path.empty()) fail_to_load("there is no file '" + name + "' here or in the additional search path", error);
  try {
    const std::vector<int> ids = (client.*load)(path, {.flags = flags});
    print_notes(client);
    return tuple_of(ids, [](int id) { return of(id); });
  } catch (const Error&) {
    throw;
  } catch (const std::exception& reason) {
    fail_to_load(reason.what(), error);
  }
}

PyObject* load_mjcf(Client& client, const Arguments& a) {
  return load_all(client, &Client::load_mjcf, a.text(0), a.integer(1, 0), "Cannot load MJCF file.");
}

PyObject* load_sdf(Client& client, const Arguments& a) {
  if (a.number(2, 1) != 1) throw Error("loadSDF: a globalScaling other than 1 is not supported");
  return load_all(client, &Client::load_sdf, a.text(0), 0, "Cannot load SDF file.");
}

constexpr Function kLoadSdf{"loadSDF", "sdfFileName | useMaximalCoordinates=0, globalScaling=1",
                            "Loads all models of an SDF file and returns a tuple of their ids.", load_sdf};

constexpr Function kLoadMjcf{"loadMJCF", "mjcfFileName | flags=0, useMultiBody=-1",
                             "Loads all bodies of an MJCF file and returns a tuple of their ids.", load_mjcf};

constexpr Function kRemoveBody{"removeBody", "bodyUniqueId",
                               "Takes a body away, with the constraints that use it. An unknown id only warns.",
                               [](Client& client, const Arguments& a) -> PyObject* {
                                 const int id = a.integer(0);
                                 if (!client.has_body(id)) PySys_FormatStdout("b3Warning: Removing body failed\n");
                                 client.remove(id);
                                 return none();
                               }};

constexpr Function kNumBodies{
    "getNumBodies", "", "How many bodies there are.",
    [](Client& client, const Arguments&) -> PyObject* { return of(static_cast<int>(client.body_ids().size())); }};

constexpr Function kBodyId{"getBodyUniqueId", "serialIndex", "The id of body 0 to getNumBodies() - 1; -1 beyond.",
                           [](Client& client, const Arguments& a) -> PyObject* {
                             const int i = a.integer(0);
                             const bool is_there = i >= 0 && i < static_cast<int>(client.body_ids().size());
                             return of(is_there ? client.body_ids()[static_cast<std::size_t>(i)] : -1);
                           }};

constexpr Function kBodyInfo{"getBodyInfo", "bodyUniqueId", "Names of the base link and of the body, as bytes.",
                             [](Client& client, const Arguments& a) -> PyObject* {
                               const bullet::BodyPlan& plan = client.plan(a.integer(0), "Couldn't get body info");
                               return tuple(bytes(plan.base.name), bytes(plan.name));
                             }};

constexpr Function kSync{"syncBodyInfo", "", "Of networks; without effect here.",
                         [](Client&, const Arguments&) -> PyObject* { return none(); }};

constexpr Function kNumJoints{
    "getNumJoints", "bodyUniqueId", "How many joints the body has, fixed ones included; 0 of an unknown body.",
    [](Client& client, const Arguments& a) -> PyObject* { return of(client.num_joints(a.integer(0))); }};

constexpr Function kDofs{
    "computeDofCount", "bodyUniqueId", "Degrees of freedom of the body's joints.",
    [](Client& client, const Arguments& a) -> PyObject* { return of(client.num_dofs(a.integer(0))); }};

PyObject* joint_info(Client& client, const Arguments& a) {
  constexpr const char* kError = "GetJointInfo failed";
  const int id = a.integer(0), joint = a.integer(1);
  client.require_joint(id, joint, kError);
  const bullet::BodyPlan& plan = client.plan(id, kError);
  const bullet::LinkPlan& link = plan.link(joint);
  const Transform<double>& X_PI = plan.link(link.parent).X_LI;
  const Transform<double> X_in_parent = inverse(X_PI) * link.X_PJ;
  const Mat3<double> turn = inverse(Transform<double>{X_in_parent.R * link.X_LI.R, {0, 0, 0}}).R;
  const bool turns =
      link.joint == JointType::kRevolute || link.joint == JointType::kContinuous || link.joint == JointType::kPrismatic;
  const Vec3<double> axis = turns ? transpose_times(link.X_LI.R, link.axis) : Vec3<double>{0, 0, 0};
  const auto [q, v] = client.joint_indices(id, joint);
  return tuple(of(joint), bytes(link.joint_name), of(static_cast<int>(bullet::joint_code(link.joint))), of(q), of(v),
               of(turns ? 1 : 0), of(link.damping), of(link.friction), of(link.lower), of(link.upper),
               of(link.max_force), of(link.max_velocity), bytes(link.name), of(axis), of(X_in_parent.p), of(turn),
               of(link.parent));
}

constexpr Function kJointInfo{
    "getJointInfo", "bodyUniqueId, jointIndex",
    "A tuple: index, name (bytes), type, index in q, index in v, flags, damping, friction, lower and upper limit, "
    "largest force and velocity, name of the link (bytes), axis, position and orientation in the parent's "
    "centre-of-mass frame, index of the parent.",
    joint_info};

}  // namespace

void add_bodies(Methods& methods) {
  add_to<kLoadUrdf>(methods);
  add_to<kLoadMjcf>(methods);
  add_to<kLoadSdf>(methods);
  add_to<kRemoveBody>(methods);
  add_to<kNumBodies>(methods);
  add_to<kBodyId>(methods);
  add_to<kBodyInfo>(methods);
  add_to<kSync>(methods);
  add_to<kNumJoints>(methods);
  add_to<kDofs>(methods);
  add_to<kJointInfo>(methods);
}

}  // namespace manyhands::pybullet
