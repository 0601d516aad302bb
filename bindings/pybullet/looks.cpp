// Cameras, colours and textures.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cmath>
#include <numbers>

#include "bindings/pybullet/arguments.h"
#include "bindings/pybullet/clients.h"

namespace nb = nanobind;

namespace manyhands::pybullet {

namespace {

using Matrix = std::array<double, 16>;  // column by column

PyObject* of(const Matrix& m) { return pybullet::of(std::span<const double>(m)); }
using pybullet::of;

Vec3<double> unit(const Vec3<double>& a) {
  const double length = norm(a);
  return length > 0 ? (1 / length) * a : a;
}

Matrix view_matrix(const Vec3<double>& eye, const Vec3<double>& target, const Vec3<double>& up) {
  const Vec3<double> f = unit(target - eye), s = unit(cross(f, unit(up))), u = cross(s, f);
  return {s.x, u.x, -f.x, 0, s.y, u.y, -f.y, 0, s.z, u.z, -f.z, 0, -dot(s, eye), -dot(u, eye), dot(f, eye), 1};
}

constexpr double kDegree = std::numbers::pi / 180;

/// The camera's eye and its upward direction turn about the target: by pitch, then roll, then yaw.
Matrix view_from_angles(const Vec3<double>& target, double distance, double yaw, double pitch, double roll,
                        int up_axis) {
  const double y = yaw * kDegree, p = pitch * kDegree, r = roll * kDegree;
  const auto about_x = [](double a, const Vec3<double>& v) {
    return Vec3<double>{v.x, std::cos(a) * v.y - std::sin(a) * v.z, std::sin(a) * v.y + std::cos(a) * v.z};
  };
  const auto about_y = [](double a, const Vec3<double>& v) {
    return Vec3<double>{std::cos(a) * v.x + std::sin(a) * v.z, v.y, -std::sin(a) * v.x + std::cos(a) * v.z};
  };
  const auto about_z = [](double a, const Vec3<double>& v) {
    return Vec3<double>{std::cos(a) * v.x - std::sin(a) * v.y, std::sin(a) * v.x + std::cos(a) * v.y, v.z};
  };
  if (up_axis == 1) {
    const auto turn = [&](const Vec3<double>& v) { return about_z(r, about_y(y, about_x(-p, v))); };
    return view_matrix(target + turn({0, 0, -distance}), target, turn({0, 1, 0}));
  }
  const auto turn = [&](const Vec3<double>& v) { return about_z(y, about_y(r, about_x(p, v))); };
  return view_matrix(target + turn({0, -distance, 0}), target, turn({0, 0, 1}));
}

constexpr FreeFunction kView{"computeViewMatrix", "cameraEyePosition, cameraTargetPosition, cameraUpVector",
                             "The view matrix of a camera that looks from eye to target; 16 numbers by columns.",
                             [](const Arguments& a) -> PyObject* {
                               return of(view_matrix(a.vec3(0, "cameraEyePosition needs 3 numbers."),
                                                     a.vec3(1, "cameraTargetPosition needs 3 numbers."),
                                                     a.vec3(2, "cameraUpVector needs 3 numbers.")));
                             }};

constexpr FreeFunction kViewAngles{
    "computeViewMatrixFromYawPitchRoll", "cameraTargetPosition, distance, yaw, pitch, roll, upAxisIndex",
    "The view matrix of a camera about a target; angles in degrees. A negative pitch looks down. upAxisIndex: 1 (y) or "
    "2 (z).",
    [](const Arguments& a) -> PyObject* {
      return of(view_from_angles(a.vec3(0, "cameraTargetPosition needs 3 numbers."), a.number(1), a.number(2),
                                 a.number(3), a.number(4), a.integer(5)));
    }};

Matrix projection(double l, double r, double b, double t, double n, double f) {
  return {2 * n / (r - l),
          0,
          0,
          0,
          0,
          2 * n / (t - b),
          0,
          0,
          (r + l) / (r - l),
          (t + b) / (t - b),
          -(f + n) / (f - n),
          -1,
          0,
          0,
          -2 * f * n / (f - n),
          0};
}

constexpr FreeFunction kProjection{
    "computeProjectionMatrix", "left, right, bottom, top, nearVal, farVal",
    "The projection of a frustum; 16 numbers by columns.", [](const Arguments& a) -> PyObject* {
      return of(projection(a.number(0), a.number(1), a.number(2), a.number(3), a.number(4), a.number(5)));
    }};

constexpr FreeFunction kProjectionFov{"computeProjectionMatrixFOV", "fov, aspect, nearVal, farVal",
                                      "The projection of a vertical field of view [degrees].",
                                      [](const Arguments& a) -> PyObject* {
                                        const double n = a.number(2), t = n * std::tan(0.5 * kDegree * a.number(0));
                                        const double r = t * a.number(1);
                                        return of(projection(-r, r, -t, t, n, a.number(3)));
                                      }};

template <class T>
nb::object array_of(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
  // NOLINTBEGIN(cppcoreguidelines-owning-memory): the array's capsule owns it
  auto* const owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  // NOLINTEND(cppcoreguidelines-owning-memory)
  return nb::cast(nb::ndarray<nb::numpy, T>(owned->data(), shape.size(), shape.begin(), owner));
}

/// Through the Python package, which reads images; nothing, with a warning, where it cannot.
std::shared_ptr<const Image> read_image(const std::string& file) {
  const nb::gil_scoped_acquire interpreter;
  const nb::object texture = nb::module_::import_("manyhands.textures").attr("texture_or_warning")(file);
  return texture.is_none() ? nullptr : nb::cast<const Texture&>(texture).image;
}

/// 16 numbers; anything else is passed over, as PyBullet does.
bool take_matrix(const Arguments& a, std::size_t i, Matrix& to) {
  if (!a.has(i)) return false;
  const std::vector<double> numbers = a.numbers(i);
  if (numbers.size() != to.size()) return false;
  std::copy(numbers.begin(), numbers.end(), to.begin());
  return true;
}

PyObject* camera_image(Client& client, const Arguments& a) {
  constexpr int kLargest = 16384, kLinks = 1, kNoMask = 4;
  bullet::PictureRequest request{.width = a.integer(0), .height = a.integer(1)};
  if (request.width < 1 || request.height < 1 || request.width > kLargest || request.height > kLargest) {
    throw Error("getCameraImage: width and height must lie between 1 and 16384");
  }
  const double aspect = static_cast<double>(request.width) / request.height;
  const double top = 0.1 * std::tan(0.5 * kDegree * 60);
  if (!take_matrix(a, 2, request.view)) request.view = view_from_angles({0, 0, 0}, 2, 50, -35, 0, 2);
  if (!take_matrix(a, 3, request.projection))
    request.projection = projection(-top * aspect, top * aspect, -top, top, 0.1, 100);
  request.light = a.optional_vec3(4, "lightDirection needs 3 numbers.");
  request.shadow = a.integer(7, 0) != 0;
  request.ambient = a.number(8, 0.6);
  request.diffuse = a.number(9, 0.35);
  const int flags = a.integer(12, 0);
  request.links_too = (flags & kLinks) != 0;
  request.segmentation = (flags & kNoMask) == 0;
  const std::size_t w = static_cast<std::size_t>(request.width), h = static_cast<std::size_t>(request.height);
  std::vector<std::uint8_t> rgba(4 * w * h);
  std::vector<float> depth(w * h);
  std::vector<std::int32_t> segmentation(w * h, -1);
  {
    const nb::gil_scoped_release release;
    client.take_picture(request, {rgba, depth, segmentation}, read_image);
  }
  return tuple(of(request.width), of(request.height), array_of(std::move(rgba), {h, w, 4}).release().ptr(),
               array_of(std::move(depth), {h, w}).release().ptr(),
               array_of(std::move(segmentation), {h, w}).release().ptr());
}

constexpr Function kImage{
    "getCameraImage",
    "width, height | viewMatrix=None, projectionMatrix=None, lightDirection=None, lightColor=None, lightDistance=None, "
    "shadow=0, lightAmbientCoeff=0.6, lightDiffuseCoeff=0.35, lightSpecularCoeff=0.05, renderer=0, flags=0, "
    "projectiveTextureView=None, projectiveTextureProj=None",
    "A picture: width, height, colours (height, width, 4) uint8, OpenGL's depth (height, width) float32, and body ids "
    "(height, width) int32, -1 where nothing is. renderer, lightColor, lightDistance, lightSpecularCoeff and "
    "projective "
    "textures have no effect here.",
    camera_image};

/// Sizes as getVisualShapeData tells them.
Vec3<double> dimensions(const bullet::ShapePlan& shape) {
  const Vec3<double>& s = shape.geom.shape.size;
  switch (shape.geom.shape.type) {
    case ShapeType::kSphere:
      return {s.x, 0, 0};
    case ShapeType::kBox:
      return 2.0 * s;
    case ShapeType::kCapsule:
    case ShapeType::kCylinder:
      return {2 * s.y, s.x, 0};
    case ShapeType::kPlane:
      return {0, 0, 1};
    default:
      return shape.scale;
  }
}

/// Whether both are objects of a file, which are told as one shape.
bool is_of_same_file(const bullet::ShapePlan& a, const bullet::ShapePlan& b) {
  return !b.file.empty() && a.file == b.file && norm(a.geom.X_LG.p - b.geom.X_LG.p) == 0;
}

PyObject* visual_data(Client& client, const Arguments& a) {
  const int id = a.integer(0);
  const bool textures = (a.integer(1, 0) & 1) != 0;
  if (!client.has_body(id)) return PyTuple_New(0);
  const bullet::BodyPlan& plan = client.plan(id, "");
  std::vector<PyObject*> rows;
  for (int i = -1; i < plan.num_links(); ++i) {
    const std::vector<bullet::ShapePlan>& visuals = plan.link(i).visuals;
    for (std::size_t k = 0; k < visuals.size(); ++k) {
      const bullet::ShapePlan& v = visuals[k];
      if (k > 0 && is_of_same_file(visuals[k - 1], v)) continue;
      const std::array<float, 4>& c = client.rgba(id, i, k);
      PyObject* const colour = tuple(of(double{c[0]}), of(double{c[1]}), of(double{c[2]}), of(double{c[3]}));
      PyObject* const type = of(static_cast<int>(bullet::shape_code(v.geom.shape.type)));
      rows.push_back(textures ? tuple(of(id), of(i), type, of(dimensions(v)), bytes(v.file), of(v.geom.X_LG.p),
                                      of(v.geom.X_LG.R), colour, of(client.texture(id, i, k)))
                              : tuple(of(id), of(i), type, of(dimensions(v)), bytes(v.file), of(v.geom.X_LG.p),
                                      of(v.geom.X_LG.R), colour));
    }
  }
  return tuple_of(rows, [](PyObject* row) { return row; });
}

constexpr Function kVisualData{"getVisualShapeData", "objectUniqueId | flags=0",
                               "Of each shape that is seen: body, link, type, dimensions, mesh file, position and "
                               "orientation in the link's frame, "
                               "colour; with VISUAL_SHAPE_DATA_TEXTURE_UNIQUE_IDS also the texture.",
                               visual_data};

PyObject* collision_data(Client& client, const Arguments& a) {
  constexpr const char* kError = "Error receiving collision shape info";
  const int id = a.integer(0), link = a.integer(1);
  const bullet::BodyPlan& plan = client.plan(id, kError);
  if (link < -1 || link >= plan.num_links()) throw Error(kError);
  std::vector<bullet::ShapePlan> shapes;
  for (const bullet::ShapePlan& shape : plan.link(link).collisions) {
    if (shapes.empty() || !is_of_same_file(shapes.back(), shape)) shapes.push_back(shape);
  }
  return tuple_of(shapes, [&](const bullet::ShapePlan& shape) {
    const Transform<double> X = inverse(plan.link(link).X_LI) * shape.geom.X_LG;
    const double r = shape.geom.shape.size.x;
    const bool round = shape.geom.shape.type == ShapeType::kSphere;
    const std::string file = shape.file.empty() && shape.geom.shape.mesh.is_valid() ? "unknown_file" : shape.file;
    return tuple(of(id), of(link), of(static_cast<int>(bullet::shape_code(shape.geom.shape.type))),
                 of(round ? Vec3<double>{r, r, r} : dimensions(shape)), bytes(file), of(X.p), of(X.R));
  });
}

constexpr Function kCollisionData{
    "getCollisionShapeData", "objectUniqueId, linkIndex",
    "Of each colliding shape: body, link, type, dimensions, mesh file, position and orientation in the centre-of-mass "
    "frame.",
    collision_data};

PyObject* change_visual(Client& client, const Arguments& a) {
  bullet::VisualChange change{.shape = a.integer(2, -1)};
  if (a.has(3) && a.integer(3) >= -1) change.texture = a.integer(3);
  const std::vector<double> rgba = a.numbers(4);
  if (!rgba.empty()) {
    if (rgba.size() != 4) throw Error("rgbaColor needs 4 numbers.");
    change.rgba = std::array<float, 4>{};
    for (std::size_t k = 0; k < 4; ++k) (*change.rgba)[k] = static_cast<float>(rgba[k]);
  }
  client.change_visual(a.integer(0), a.integer(1), change);
  return none();
}

constexpr const char* kChangeSignature =
    "objectUniqueId, linkIndex | shapeIndex=-1, textureUniqueId=-2, rgbaColor=None, specularColor=None, flags=0";
constexpr const char* kChangeDoc =
    "Gives a link's shapes another colour or texture (-1: none). specularColor is not drawn: surfaces are matt.";
constexpr Function kChangeVisual{"changeVisualShape", kChangeSignature, kChangeDoc, change_visual};
constexpr Function kResetVisual{"resetVisualShapeData", kChangeSignature, kChangeDoc, change_visual};

constexpr Function kLoadTexture{"loadTexture", "textureFilename", "Reads an image and returns a texture's id.",
                                [](Client& client, const Arguments& a) -> PyObject* {
                                  const std::string path = find_file(a.text(0));
                                  if (path.empty()) throw Error("Error loading texture");
                                  const std::shared_ptr<const Image> image = read_image(path);
                                  if (image == nullptr) throw Error("Error loading texture");
                                  const int id = client.add_texture(image);
                                  return of(id);
                                }};

constexpr Function kChangeTexture{
    "changeTexture", "textureUniqueId, pixels, width, height",
    "Gives a texture other pixels: 3 x width x height numbers, 0 to 255.",
    [](Client& client, const Arguments& a) -> PyObject* {
      std::vector<std::uint8_t> pixels;
      for (const double x : a.numbers(1)) {
        pixels.push_back(static_cast<std::uint8_t>(std::clamp(x, 0.0, 255.0)));
      }
      const int width = a.integer(2), height = a.integer(3);
      if (width < 1 || height < 1 ||
          pixels.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        throw Error("changeTexture: expected 3 x width x height numbers");
      }
      client.change_texture(a.integer(0), std::make_shared<const Image>(width, height, pixels));
      return none();
    }};

}  // namespace

ScreenMatrices screen_matrices(const bullet::Screen& screen) {
  constexpr double kNear = 0.01, kFar = 1000;  // [m], as in PyBullet's window; its height is seen under 90 degrees
  const auto& [distance, yaw, pitch, target] = screen.camera;
  const Matrix v = view_from_angles(target, distance, yaw, pitch, 0, 2);
  return {v,
          projection(-kNear * screen.aspect(), kNear * screen.aspect(), -kNear, kNear, kNear, kFar),
          {-v[2], -v[6], -v[10]},
          {v[0], v[4], v[8]},
          {v[1], v[5], v[9]}};
}

void add_looks(Methods& methods) {
  add_to<kView>(methods);
  add_to<kViewAngles>(methods);
  add_to<kProjection>(methods);
  add_to<kProjectionFov>(methods);
  add_to<kImage>(methods);
  add_to<kVisualData>(methods);
  add_to<kCollisionData>(methods);
  add_to<kChangeVisual>(methods);
  add_to<kResetVisual>(methods);
  add_to<kLoadTexture>(methods);
  add_to<kChangeTexture>(methods);
}

}  // namespace manyhands::pybullet
