// <geom>: its shape, place, surface and mass.
#include <algorithm>
#include <cmath>

#include "manyhands/model/hull_mesh.h"
#include "manyhands/model/io/ellipsoid_points.h"
#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_scene.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/principal_axes.h"

namespace manyhands::io {

namespace {

MeshId ellipsoid_hull(MjcfScene& scene, const Vec3<double>& s) {
  const auto [entry, is_new] = scene.ellipsoids.try_emplace({s.x, s.y, s.z});
  if (is_new) entry->second = scene.builder.add_mesh(hull_of(points_on_ellipsoid(s)));
  return entry->second;
}

/// What the readers of shapes work on.
struct Part {
  const MjcfElement& element;
  std::string type;
  Geom geom{};
  Inertial volume{};  ///< mass properties at density 1 in the geom's frame, of its skin if that alone has mass
};

/// The first `count` sizes, of which those that `fromto` tells are left out.
std::vector<double> read_size(const MjcfElement& e, std::size_t count) {
  const std::vector<double> size = e.has("size") ? e.numbers("size", count, 3) : std::vector<double>{};
  if (size.size() < count) {
    e.fail("attribute 'size' of <geom> is missing; expected " + std::to_string(count) + " numbers");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!(size[i] > 0)) e.fail("size " + format_number(size[i]) + " is not above 0");
  }
  return size;
}

/// The shape of these sizes, and its volume.
void set_primitive(MjcfScene& scene, Part& part, const Vec3<double>& size) {
  const MjcfElement& e = part.element;
  Shape& shape = part.geom.shape;
  const bool is_skin = e.boolean_or("shellinertia", false);
  if (part.type == "ellipsoid") {
    shape = {.type = ShapeType::kConvex, .mesh = ellipsoid_hull(scene, size)};
    part.volume = is_skin ? skin_of_ellipsoid(size) : solid_ellipsoid(size);
    e.note_once("ellipsoid", LoadAction::kRepaired, "the ellipsoid became the hull of 162 points on it");
    return;
  }
  shape.type = part.type == "sphere"    ? ShapeType::kSphere
               : part.type == "capsule" ? ShapeType::kCapsule
               : part.type == "box"     ? ShapeType::kBox
                                        : ShapeType::kCylinder;
  shape.size = size;
  part.volume = is_skin ? skin_of(shape) : solid_of(shape);
}

void read_primitive(MjcfScene& scene, Part& part, const MjcfPlaced& placed) {
  const MjcfElement& e = part.element;
  const bool has_ends = e.has("fromto");
  const bool is_round = part.type == "capsule" || part.type == "cylinder";
  if (has_ends && !is_round && part.type != "box" && part.type != "ellipsoid") {
    e.fail("'fromto' places capsules, cylinders, boxes and ellipsoids only");
  }
  const std::size_t sizes = part.type == "sphere" || has_ends ? 1 : is_round ? 2 : 3;
  const std::vector<double> given = read_size(e, sizes);
  Vec3<double> size{given[0], sizes > 1 ? given[1] : 0, sizes > 2 ? given[2] : 0};
  if (has_ends) {
    const std::vector<double> v = e.numbers("fromto", 6, 6);
    const Vec3<double> from{v[0], v[1], v[2]}, to{v[3], v[4], v[5]};
    const double half = 0.5 * norm(from - to);
    if (!(half > 1e-10)) e.fail("the ends of 'fromto' are one point");
    part.geom.X_LG = placed_in(placed.X_BF, {rotation_from_z(from - to), 0.5 * (from + to)});
    size = is_round ? Vec3<double>{given[0], half, 0} : Vec3<double>{given[0], given[0], half};
  }
  set_primitive(scene, part, size);
}

/// The shape of a mesh; false if that has been left out.
bool fit_primitive(MjcfScene& scene, Part& part, const MjcfPlaced& placed) {
  const MjcfElement& e = part.element;
  if (e.has("fromto")) e.fail("'fromto' places no shape that is fitted to a mesh");
  const MjcfMesh* const mesh = scene.assets.mesh(e.text("mesh"), e);
  if (mesh == nullptr) return false;
  const MjcfFit fit = fitted(part.type, *mesh, scene.settings_of(e).fit_to_box);
  part.geom.X_LG = placed_in(placed.X_BF, placed_in(read_pose(e, scene.settings_of(e)), fit.X_MS));
  set_primitive(scene, part, e.number_or("fitscale", 1) * fit.size);
  return true;
}

/// Planes and height fields belong to what never moves.
void require_fixed(const Part& part, const MjcfBody& body) {
  if (body.first_moving != 0) part.element.fail("a " + part.type + " lies on a body that moves; expected a fixed one");
}

/// Reads the shape into `part`; false if it is left out, which is noted.
bool read_shape(MjcfScene& scene, const MjcfBody& body, Part& part, const MjcfPlaced& placed) {
  const MjcfElement& e = part.element;
  part.geom.X_LG = placed_in(placed.X_BF, read_pose(e, scene.settings_of(e)));
  if (part.type == "plane") {
    require_fixed(part, body);
    part.geom.shape.type = ShapeType::kPlane;
    return true;
  }
  if (part.type == "hfield") {
    require_fixed(part, body);
    const auto id = scene.assets.height_field(e.text("hfield"), e, scene.builder);
    if (!id) return false;
    part.geom.shape = {.type = ShapeType::kHeightField, .height_field = *id};
    return true;
  }
  if (part.type == "mesh") {
    const MjcfMesh* const mesh = scene.assets.mesh(e.text("mesh"), e);
    if (mesh == nullptr) return false;
    part.geom.shape = {.type = ShapeType::kConvex, .mesh = scene.assets.mesh_id(e.text("mesh"), e, scene.builder)};
    part.volume = mesh->per_density;
    return true;
  }
  if (part.type == "sdf") {
    e.note_serious(LoadAction::kIgnored, "signed distance fields are not read; the geom is left out");
    return false;
  }
  if (e.has("mesh")) return fit_primitive(scene, part, placed);
  read_primitive(scene, part, placed);
  return true;
}

std::array<double, 3> read_friction(const MjcfElement& e) {
  std::array<double, 3> friction{1, 0.005, 0.0001};
  if (e.has("friction")) std::ranges::copy(e.numbers("friction", 1, 3), friction.begin());
  if (*std::ranges::min_element(friction) < 0) e.fail("a coefficient of friction is negative; expected 0 or more");
  return friction;
}

}  // namespace

SurfaceMaterial surface_of(const std::array<double, 3>& friction, int condim) {
  SurfaceMaterial surface;
  surface.lateral_friction = condim >= 3 ? friction[0] : 0;
  surface.spinning_friction = condim >= 4 ? friction[1] : 0;
  surface.rolling_friction = condim >= 6 ? friction[2] : 0;
  return surface;
}

int read_condim(const MjcfElement& e, int fallback) {
  const int condim = e.integer_or("condim", fallback);
  if (condim != 1 && condim != 3 && condim != 4 && condim != 6) {
    e.fail("condim is " + std::to_string(condim) + "; expected 1, 3, 4 or 6");
  }
  return condim;
}

MjcfGeomMass add_geom(MjcfScene& scene, int body_index, const MjcfPlaced& placed) {
  const MjcfBody& body = scene.bodies[static_cast<std::size_t>(body_index)];
  const std::string name = claim_name(scene.geom_names, placed.element, "geom", scene.geoms.size(), scene.reserved);
  const MjcfElement e = placed.element.named("geom '" + name + "'").with_defaults(scene.classes, "geom");
  e.expect(
      {"name",        "class", "type",     "pos",        "quat",      "axisangle",   "euler",    "xyaxes", "zaxis",
       "fromto",      "size",  "mesh",     "hfield",     "mass",      "density",     "friction", "condim", "contype",
       "conaffinity", "rgba",  "material", "margin",     "group",     "gap",         "solref",   "solimp", "solmix",
       "priority",    "user",  "fitscale", "fluidshape", "fluidcoef", "shellinertia"},
      {});
  e.ignore({"gap", "user", "fluidcoef"});
  if (e.word_or("fluidshape", {"none", "ellipsoid"}, "none") == "ellipsoid" && scene.settings.medium.drags())
    e.note_serious(LoadAction::kRepaired, "a medium drags on the box of its body's inertia, not on an ellipsoid");
  MjcfGeom entry{.name = name, .id = {}, .source = e, .body = body_index};
  entry.contype = e.integer_or("contype", 1);
  entry.conaffinity = e.integer_or("conaffinity", 1);
  entry.condim = read_condim(e, 3);
  entry.priority = e.integer_or("priority", 0);
  entry.friction = read_friction(e);
  entry.compliance = read_surface_compliance(e, scene.compliance);

  Part part{
      .element = e,
      .type = e.word_or("type", {"plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"},
                        "sphere")};
  if (!e.has("type") && e.has("mesh")) part.type = "mesh";
  MjcfGeomMass mass;
  mass.group = e.integer_or("group", 0);
  if (read_shape(scene, body, part, placed)) {
    Geom& geom = part.geom;
    geom.name = name;
    geom.link = body.link;
    geom.surface = surface_of(entry.friction, entry.condim);
    geom.surface.compliance = entry.compliance;
    geom.margin = e.positive_or("margin", 0);
    geom.rgba = {0.5f, 0.5f, 0.5f, 1};
    if (e.has("material") && !(e.source().is_bullet() && !scene.assets.has_material(e.text("material")))) {
      const MjcfMaterial& material = scene.assets.material(e.text("material"), e);
      geom.rgba = material.rgba;
      geom.texture = texture_on(geom.shape.type, material, e);
    }
    geom.rgba = read_rgba(e, geom.rgba);
    constexpr double kUsual = 1000;                 // [kg/m^3]
    const bool is_bullet = e.source().is_bullet();  // which knows no mass of geoms, and one density
    double factor = is_bullet ? kUsual : e.positive_or("density", kUsual);
    if (e.has("mass") && !is_bullet) factor = part.volume.mass > 0 ? e.positive_or("mass", 0) / part.volume.mass : 0;
    mass.inertial = manyhands::placed(geom.X_LG, scaled(part.volume, factor));
    if (is_bullet && !e.has("fromto")) mass.inertial.com = Vec3<double>::zero();
    mass.axes = part.type == "mesh" ? geom.X_LG.R * principal_axes(part.volume.inertia).R : geom.X_LG.R;
    entry.id = checked(e, [&] { return scene.builder.add_geom(std::move(geom)); });
  }
  scene.geoms.push_back(std::move(entry));
  return mass;
}

}  // namespace manyhands::io
