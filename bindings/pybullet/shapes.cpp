// Bodies that programs make of shapes, and what shapes bodies have.
#include "bindings/pybullet/arguments.h"
#include "bindings/pybullet/clients.h"
#include "manyhands/model/io/mesh/mesh_file.h"

namespace manyhands::pybullet {

namespace {

using bullet::ShapeRecord;

/// What all functions that make shapes ask of a shape.
struct ShapeArguments {
  int type = 0;
  double radius = 0.5;
  std::optional<Vec3<double>> half_extents{};
  double length = 1;
  std::string file{};
  Vec3<double> scale{1, 1, 1};
  Vec3<double> normal{0, 0, 1};
  int flags = 0;
  std::vector<Vec3<double>> vertices{};
  std::vector<int> indices{};
};

Mat3<double> to_normal(const Vec3<double>& n) {
  const double length = norm(n);
  if (!(length > 1e-12) || n.z >= length) return Mat3<double>::identity();
  const Vec3<double> z = (1 / length) * n;
  const Vec3<double> side = std::abs(z.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
  Vec3<double> y = cross(z, side);
  y = (1 / norm(y)) * y;
  return {cross(y, z), y, z};
}

std::shared_ptr<const Mesh> mesh_of(const ShapeArguments& s) {
  if (s.vertices.empty()) return std::make_shared<const Mesh>(load_mesh(find_file(s.file), s.scale));
  Mesh mesh{.source = "vertices"};
  for (const Vec3<double>& p : s.vertices) {
    mesh.vertices.push_back({static_cast<float>(s.scale.x * p.x), static_cast<float>(s.scale.y * p.y),
                             static_cast<float>(s.scale.z * p.z)});
  }
  for (std::size_t i = 0; i + 2 < s.indices.size(); i += 3) {
    mesh.triangles.push_back({s.indices[i], s.indices[i + 1], s.indices[i + 2]});
  }
  return std::make_shared<const Mesh>(std::move(mesh));
}

/// Throws Error with `what` where the numbers make no shape.
ShapeRecord shape_of(const ShapeArguments& s, bool collides, const char* what) {
  ShapeRecord record{.file = s.file, .scale = s.scale};
  const auto require = [&](bool good) {
    if (!good) throw Error(what);
  };
  switch (s.type) {
    case bullet::kSphere:
      require(s.radius > 0);
      record.shape = {ShapeType::kSphere, {s.radius, 0, 0}};
      break;
    case bullet::kBox: {
      require(s.half_extents.has_value() || !collides);
      const Vec3<double> half = s.half_extents.value_or(Vec3<double>{1, 1, 1});
      require(half.x > 0 && half.y > 0 && half.z > 0);
      record.shape = {ShapeType::kBox, half};
      break;
    }
    case bullet::kCylinder:
    case bullet::kCapsule:
      require(s.radius > 0 && s.length > 0);
      record.shape = {s.type == bullet::kCylinder ? ShapeType::kCylinder : ShapeType::kCapsule,
                      {s.radius, 0.5 * s.length, 0}};
      break;
    case bullet::kPlane:
      record.shape.type = ShapeType::kPlane;
      record.pose.R = to_normal(s.normal);
      break;
    case bullet::kMesh: {
      constexpr int kConcave = 1;
      record.mesh = mesh_of(s);
      const bool triangles = !collides || (s.vertices.empty() ? (s.flags & kConcave) != 0 : !s.indices.empty());
      record.shape.type = triangles ? ShapeType::kMesh : ShapeType::kConvex;
      break;
    }
    default:
      throw Error(what);
  }
  return record;
}

constexpr const char* kNoShape = "createCollisionShape failed.";
constexpr const char* kNoVisual = "createVisualShape failed.";

/// One shape, or the hulls of a file's objects.
std::vector<ShapeRecord> collision_shapes_of(const ShapeArguments& s) {
  constexpr int kConcave = 1;
  const bool by_objects = s.type == bullet::kMesh && s.vertices.empty() && (s.flags & kConcave) == 0;
  if (!by_objects) return {shape_of(s, true, kNoShape)};
  const std::string file = find_file(s.file);
  if (file.empty()) throw Error("createCollisionShape: there is no file '" + s.file + "'");
  std::vector<ShapeRecord> records;
  for (Mesh& object : load_mesh_objects(file, s.scale)) {
    records.push_back({.shape = {.type = ShapeType::kConvex}, .file = s.file, .scale = s.scale});
    records.back().mesh = std::make_shared<const Mesh>(std::move(object));
  }
  return records;
}

ShapeRecord height_field_of(const Arguments& a) {
  const std::vector<double> data = a.numbers(13);
  const int rows = a.integer(14, 0), columns = a.integer(15, 0);
  if (rows < 2 || columns < 2 || data.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns)) {
    throw Error(kNoShape);
  }
  const Vec3<double> scale = a.vec3(5, {1, 1, 1}, "meshScale needs 3 numbers.");
  HeightField field{.columns = rows, .rows = columns, .dx = scale.x, .dy = scale.y};
  double low = data[0], high = data[0];
  for (const double z : data) {
    low = std::min(low, z);
    high = std::max(high, z);
  }
  for (const double z : data) field.height.push_back(scale.z * (z - 0.5 * (low + high)));
  ShapeRecord record{.shape = {.type = ShapeType::kHeightField}};
  record.height_field = std::make_shared<const HeightField>(std::move(field));
  return record;
}

/// The arguments that both functions have; `vertices` and `indices` stand at that number.
ShapeArguments shape_arguments(const Arguments& a, std::size_t vertices) {
  ShapeArguments s{.type = a.integer(0), .radius = a.number(1, 0.5)};
  s.half_extents = a.optional_vec3(2, "halfExtents needs 3 numbers.");
  s.length = a.number(3, 1);
  s.file = a.text(4, "");
  s.scale = a.vec3(5, {1, 1, 1}, "meshScale needs 3 numbers.");
  s.normal = a.vec3(6, {0, 0, 1}, "planeNormal needs 3 numbers.");
  s.flags = a.integer(7, 0);
  s.vertices = a.points(vertices, "vertices needs a list of 3 numbers each.");
  s.indices = a.integers(vertices + 1);
  return s;
}

PyObject* create_collision(Client& client, const Arguments& a) {
  const ShapeArguments s = shape_arguments(a, 10);
  std::vector<ShapeRecord> records;
  if (s.type == bullet::kHeightField) {
    records.push_back(height_field_of(a));
  } else {
    records = collision_shapes_of(s);
  }
  const Transform<double> X{a.rotation(9, "collisionFrameOrientation needs 4 numbers."),
                            a.vec3(8, {0, 0, 0}, "collisionFramePosition needs 3 numbers.")};
  for (ShapeRecord& record : records) record.pose = X * record.pose;
  return of(client.create_shape(std::move(records), GeomRole::kCollision));
}

constexpr Function kCreateCollision{
    "createCollisionShape",
    "shapeType | radius=0.5, halfExtents=None, height=1, fileName='', meshScale=[1, 1, 1], planeNormal=[0, 0, 1], "
    "flags=0, collisionFramePosition=[0, 0, 0], collisionFrameOrientation=[0, 0, 0, 1], vertices=None, indices=None, "
    "heightfieldTextureScaling=1, heightfieldData=None, numHeightfieldRows=-1, numHeightfieldColumns=-1, "
    "replaceHeightfieldIndex=-1",
    "Makes a shape for createMultiBody and returns its id. Meshes are their convex hulls, unless flags is "
    "GEOM_FORCE_CONCAVE_TRIMESH.",
    create_collision};

PyObject* create_visual(Client& client, const Arguments& a) {
  const ShapeArguments s = shape_arguments(a, 12);
  if (s.type == bullet::kMesh && s.vertices.empty() && find_file(s.file).empty()) {
    PySys_FormatStdout("b3Warning: createVisualShape: there is no file '%s'; nothing will be seen\n", s.file.c_str());
    return of(client.create_shape({}, GeomRole::kVisual));
  }
  ShapeRecord record = shape_of(s, false, kNoVisual);
  const Transform<double> X{a.rotation(11, "visualFrameOrientation needs 4 numbers."),
                            a.vec3(10, {0, 0, 0}, "visualFramePosition needs 3 numbers.")};
  record.pose = X * record.pose;
  const std::vector<double> rgba = a.numbers(8);
  for (std::size_t k = 0; k < rgba.size() && k < 4; ++k) record.rgba[k] = static_cast<float>(rgba[k]);
  return of(client.create_shape({std::move(record)}, GeomRole::kVisual));
}

constexpr Function kCreateVisual{
    "createVisualShape",
    "shapeType | radius=0.5, halfExtents=[1, 1, 1], length=1, fileName='', meshScale=[1, 1, 1], planeNormal=[0, 0, 1], "
    "flags=0, rgbaColor=[1, 1, 1, 1], specularColor=[1, 1, 1], visualFramePosition=[0, 0, 0], "
    "visualFrameOrientation=[0, 0, 0, 1], vertices=None, indices=None, normals=None, uvs=None",
    "Makes a shape to be seen, for createMultiBody, and returns its id. specularColor is not drawn: surfaces are matt.",
    create_visual};

/// Item i of the sequence that argument k is; null if it was not given.
class Lists {
 public:
  Lists(const Arguments& a, std::size_t n) : arguments_(a), n_(n) {}

  [[nodiscard]] PyObject* item(std::size_t argument, std::size_t i) const {
    if (!arguments_.has(argument)) return nullptr;
    PyObject* const list = arguments_.object(argument);
    if (PySequence_Size(list) != static_cast<Py_ssize_t>(n_)) {
      PyErr_Clear();
      throw Error("All shape arrays need to be same size.");
    }
    PyObject* const item = PySequence_GetItem(list, static_cast<Py_ssize_t>(i));
    if (item == nullptr) throw PythonError{};
    owned_.emplace_back(item);
    return item;
  }
  [[nodiscard]] double number(std::size_t argument, std::size_t i, double fallback) const {
    PyObject* const x = item(argument, i);
    return x == nullptr ? fallback : number_of(x);
  }
  [[nodiscard]] std::vector<double> numbers(std::size_t argument, std::size_t i) const {
    PyObject* const x = item(argument, i);
    return x == nullptr || x == Py_None ? std::vector<double>{} : numbers_of(x);
  }
  [[nodiscard]] std::string text(std::size_t argument, std::size_t i) const {
    PyObject* const x = item(argument, i);
    if (x == nullptr || x == Py_None) return {};
    const char* const text = PyUnicode_AsUTF8AndSize(x, nullptr);
    if (text == nullptr) throw PythonError{};
    return text;
  }

 private:
  struct Owned {
    explicit Owned(PyObject* o) : object(o) {}
    Owned(Owned&& other) noexcept : object(std::exchange(other.object, nullptr)) {}
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;
    ~Owned() { Py_DecRef(object); }
    PyObject* object;
  };
  const Arguments& arguments_;
  std::size_t n_;
  mutable std::vector<Owned> owned_;
};

Vec3<double> vector_or(const std::vector<double>& numbers, const Vec3<double>& fallback) {
  return numbers.size() == 3 ? Vec3<double>{numbers[0], numbers[1], numbers[2]} : fallback;
}

Mat3<double> rotation_or_none(const std::vector<double>& r) {
  return r.size() == 4 ? to_matrix(normalized(Quat<double>{r[0], r[1], r[2], r[3]})) : Mat3<double>::identity();
}

/// Both functions take the same lists; positions and orientations of frames are the arguments before `last`.
std::vector<ShapeRecord> shapes_of(const Arguments& a, bool collides, std::size_t frame, std::size_t colours) {
  const std::vector<int> types = a.integers(0);
  const Lists lists(a, types.size());
  std::vector<ShapeRecord> records;
  for (std::size_t i = 0; i < types.size(); ++i) {
    ShapeArguments s{.type = types[i], .radius = lists.number(1, i, 0.5)};
    const std::vector<double> half = lists.numbers(2, i);
    if (half.size() == 3) s.half_extents = vector_or(half, {1, 1, 1});
    s.length = lists.number(3, i, 1);
    s.file = lists.text(4, i);
    s.scale = vector_or(lists.numbers(5, i), {1, 1, 1});
    s.normal = vector_or(lists.numbers(6, i), {0, 0, 1});
    ShapeRecord record = shape_of(s, collides, collides ? kNoShape : kNoVisual);
    record.pose = Transform<double>{rotation_or_none(lists.numbers(frame + 1, i)),
                                    vector_or(lists.numbers(frame, i), {0, 0, 0})} *
                  record.pose;
    const std::vector<double> rgba = colours > 0 ? lists.numbers(colours, i) : std::vector<double>{};
    for (std::size_t k = 0; k < rgba.size() && k < 4; ++k) record.rgba[k] = static_cast<float>(rgba[k]);
    records.push_back(std::move(record));
  }
  return records;
}

constexpr Function kCollisionArray{
    "createCollisionShapeArray",
    "shapeTypes | radii=None, halfExtents=None, lengths=None, fileNames=None, meshScales=None, planeNormals=None, "
    "flags=None, collisionFramePositions=None, collisionFrameOrientations=None",
    "Makes one shape of several.", [](Client& client, const Arguments& a) -> PyObject* {
      return of(client.create_shape(shapes_of(a, true, 8, 0), GeomRole::kCollision));
    }};

constexpr Function kVisualArray{
    "createVisualShapeArray",
    "shapeTypes | radii=None, halfExtents=None, lengths=None, fileNames=None, meshScales=None, planeNormals=None, "
    "flags=None, rgbaColors=None, visualFramePositions=None, visualFrameOrientations=None",
    "Makes one visual shape of several.", [](Client& client, const Arguments& a) -> PyObject* {
      return of(client.create_shape(shapes_of(a, false, 9, 8), GeomRole::kVisual));
    }};

constexpr Function kRemoveShape{"removeCollisionShape", "collisionShapeId", "Forgets a shape; bodies keep theirs.",
                                [](Client& client, const Arguments& a) -> PyObject* {
                                  client.remove_shape(a.integer(0));
                                  return none();
                                }};

bullet::MultiBodyRequest request_of(const Arguments& a) {
  bullet::MultiBodyRequest request{.mass = a.number(0, 0),
                                   .collision_shape = a.integer(1, -1),
                                   .visual_shape = a.integer(2, -1),
                                   .flags = a.integer(18, 0)};
  request.inertial_frame = {a.rotation(6, "baseInertialFrameOrientation needs 4 numbers."),
                            a.vec3(5, {0, 0, 0}, "baseInertialFramePosition needs 3 numbers.")};
  std::size_t n = 0;
  for (std::size_t i = 7; i <= 16; ++i) {
    if (a.has(i)) n = std::max(n, static_cast<std::size_t>(std::max<Py_ssize_t>(PySequence_Size(a.object(i)), 0)));
  }
  PyErr_Clear();
  for (std::size_t i = 7; i <= 16; ++i) {
    if (n == 0) continue;
    if (!a.has(i) || PySequence_Size(a.object(i)) != static_cast<Py_ssize_t>(n)) {
      PyErr_Clear();
      throw Error("All link arrays need to be same size.");
    }
  }
  const Lists lists(a, n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto integer = [&](std::size_t argument) { return integer_of(lists.item(argument, i)); };
    request.links.push_back(
        {.mass = lists.number(7, i, 0),
         .collision_shape = integer(8),
         .visual_shape = integer(9),
         .pose = {rotation_or_none(lists.numbers(11, i)), vector_or(lists.numbers(10, i), {0, 0, 0})},
         .inertial_frame = {rotation_or_none(lists.numbers(13, i)), vector_or(lists.numbers(12, i), {0, 0, 0})},
         .parent = integer(14),
         .joint = integer(15),
         .axis = vector_or(lists.numbers(16, i), {0, 0, 1})});
  }
  return request;
}

PyObject* create_multi_body(Client& client, const Arguments& a) {
  const bullet::MultiBodyRequest request = request_of(a);
  const Transform<double> X{a.rotation(4, "baseOrientation needs 4 numbers."),
                            a.vec3(3, {0, 0, 0}, "basePosition needs 3 numbers.")};
  if (!a.has(19)) return of(client.create_body(request, X));
  return tuple_of(a.points(19, "batchPositions needs a list of 3 numbers each."),
                  [&](const Vec3<double>& p) { return of(client.create_body(request, {X.R, p})); });
}

constexpr Function kCreateMultiBody{
    "createMultiBody",
    "| baseMass=0, baseCollisionShapeIndex=-1, baseVisualShapeIndex=-1, basePosition=[0, 0, 0], "
    "baseOrientation=[0, 0, 0, 1], baseInertialFramePosition=[0, 0, 0], baseInertialFrameOrientation=[0, 0, 0, 1], "
    "linkMasses=None, linkCollisionShapeIndices=None, linkVisualShapeIndices=None, linkPositions=None, "
    "linkOrientations=None, linkInertialFramePositions=None, linkInertialFrameOrientations=None, "
    "linkParentIndices=None, linkJointTypes=None, linkJointAxis=None, useMaximalCoordinates=0, flags=0, "
    "batchPositions=None",
    "Makes a body of shapes and returns its id; with batchPositions, one at each, and a tuple of ids. Without mass it "
    "is fixed. Link lists are of one length; parent 0 is the base, k + 1 link k.",
    create_multi_body};

}  // namespace

void add_shapes(Methods& methods) {
  add_to<kCreateCollision>(methods);
  add_to<kCreateVisual>(methods);
  add_to<kCollisionArray>(methods);
  add_to<kVisualArray>(methods);
  add_to<kRemoveShape>(methods);
  add_to<kCreateMultiBody>(methods);
}

}  // namespace manyhands::pybullet
