// World: adding and removing parts.
#include <algorithm>
#include <fstream>

#include "manyhands/base/float_environment.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/model/convex_polyhedron.h"
#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/model/solids.h"
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

namespace {

/// By the root element, or what stands for it near the file's beginning.
LoadedModel load_any(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileNotFound(path);
  std::string head(1 << 16, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  const std::size_t mjcf = head.find("<mujoco"), robot = head.find("<robot");
  const bool is_urdf = path.extension() == ".urdf" || robot < mjcf;
  return is_urdf ? load_urdf(path) : load_mjcf(path);
}

bool belongs_to(const std::string& part, const std::string& name) {
  return part == name || (part.size() > name.size() && part.starts_with(name) && part[name.size()] == '/');
}

/// The convex hull as a closed mesh.
Mesh hull_of(const Mesh& mesh) {
  const ConvexPolyhedron hull = convex_polyhedron(mesh.vertices);
  Mesh result;
  for (const Vec3<double>& p : hull.vertices) {
    result.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  for (std::size_t i = 0; i < hull.faces.size(); ++i) {
    const std::span<const int> face = hull.faces[i];
    for (std::size_t k = 2; k < face.size(); ++k) result.triangles.push_back({face[0], face[k - 1], face[k]});
  }
  return result;
}

/// Mass and inertia of a solid of that shape, about the geom's origin.
Inertial solid(const NewBody& body) {
  Inertial unit;
  if (body.shape.type == ShapeType::kConvex) {
    unit = solid_of(hull_of(body.mesh), false);
  } else {
    unit = solid_of(body.shape);
  }
  if (!(unit.mass > 0)) {
    throw ModelError("body '" + body.name + "': its shape has no volume; only a fixed body may have none");
  }
  return scaled(unit, body.mass / unit.mass);
}

void check_body(const NewBody& body) {
  const std::string what = "body '" + body.name + "'";
  internal::require_pose(what, body.X_WB);
  if (!body.fixed && !(is_finite(body.mass) && body.mass > 0)) {
    throw ModelError(what + ": mass is " + std::to_string(body.mass) + " kg; expected a finite number above 0");
  }
  const bool flat = body.shape.type == ShapeType::kPlane || body.shape.type == ShapeType::kMesh;
  if (flat && !body.fixed) throw ModelError(what + ": a plane or triangle mesh must be fixed to the world");
  const SurfaceMaterial& s = body.surface;
  require_at_least(what + ": friction", 0, s.lateral_friction);
  require_at_least(what + ": spinning friction", 0, s.spinning_friction);
  require_at_least(what + ": rolling friction", 0, s.rolling_friction);
  require_at_least(what + ": restitution", 0, s.restitution);
  require_shape_size(what, body.shape);
}

void put(ModelBuilder& builder, const NewBody& body, const Inertial& inertial) {
  const LinkId link = builder.add_link(body.name, inertial);
  if (body.fixed) {
    builder.place_root(link, body.X_WB);
  } else {
    const Quat<double> r = normalized(to_quat(body.X_WB.R));
    builder.add_joint({.name = body.name + "_free",
                       .type = JointType::kFloating,
                       .parent = builder.world(),
                       .child = link,
                       .initial = {body.X_WB.p.x, body.X_WB.p.y, body.X_WB.p.z, r.x, r.y, r.z, r.w}});
  }
  Geom geom{.name = body.name, .link = link, .shape = body.shape, .rgba = body.rgba, .surface = body.surface};
  if (!body.mesh.vertices.empty()) geom.shape.mesh = builder.add_mesh(body.mesh);
  builder.add_geom(std::move(geom));
}

/// What the builder of a world's parts has besides parts.
void take_settings(const Model& model, ModelBuilder& builder) {
  builder.set_gravity(model.gravity());
  builder.set_contact_rules(model.contact_rules());
  if (model.time_step()) builder.set_time_step(*model.time_step());
}

}  // namespace

World World::from_file(const std::filesystem::path& path, std::optional<double> time_step, Integrator integrator) {
  LoadedModel loaded = load_any(path);
  const double h = time_step.value_or(loaded.model.time_step().value_or(0.002));
  World world(std::make_shared<const Model>(std::move(loaded.model)), h, integrator);
  world.report_ = std::move(loaded.report);
  return world;
}

World::Edit& World::edit() {
  if (!edit_) {
    Edit edit;
    edit.map = append(edit.builder, *core_->model);
    take_settings(*core_->model, edit.builder);
    edit_ = std::make_unique<Edit>(std::move(edit));
  }
  return *edit_;
}

/// Makes the builder anew without the links that are to go.
void World::drop_left_out() {
  if (!edit_ || edit_->left_out.empty()) return;
  const Model model = edit_->builder.build();
  std::vector<std::uint8_t> left_out(model.links().size(), 0);
  for (const int link : edit_->left_out) left_out[static_cast<std::size_t>(link)] = 1;
  Edit next;
  next.map = edit_->map.then(append(next.builder, model, {.left_out = left_out}));
  take_settings(model, next.builder);
  edit_ = std::make_unique<Edit>(std::move(next));
}

void World::apply_edit() const {
  const FloatEnvironment floats;
  const_cast<World*>(this)->drop_left_out();
  auto next = std::make_unique<WorldCore>(std::make_shared<const Model>(edit_->builder.build()));
  carry(*core_, edit_->map, *next);
  core_ = std::move(next);
  edit_.reset();
}

void World::add(const Model& model, const Transform<double>& X_WM, const std::string& name) {
  internal::require_pose("the model's place", X_WM);
  const Model& present = *core().model;
  Edit draft = std::move(edit());  // a name may be taken halfway through: then it is dropped
  edit_.reset();
  ContactRules rules = present.contact_rules(), theirs = model.contact_rules();
  const PartMap map = append(draft.builder, model, {.X_WM = X_WM, .prefix = name.empty() ? "" : name + "/"});
  if (present.geoms().empty()) rules = theirs;
  if (theirs.self_collision && !rules.self_collision) exclude_self_collision(draft.builder, present, draft.map);
  if (!theirs.self_collision && rules.self_collision) exclude_self_collision(draft.builder, model, map);
  rules.self_collision = rules.self_collision || theirs.self_collision;
  draft.builder.set_contact_rules(rules);
  edit_ = std::make_unique<Edit>(std::move(draft));
}

void World::add_file(const std::filesystem::path& path, const Transform<double>& X_WM, const std::string& name) {
  LoadedModel loaded = load_any(path);
  add(loaded.model, X_WM, name);
  report_.notes.insert(report_.notes.end(), loaded.report.notes.begin(), loaded.report.notes.end());
}

void World::add_body(const NewBody& body) {
  const FloatEnvironment floats;
  check_body(body);
  const Inertial inertial = body.fixed ? Inertial{} : solid(body);
  ModelBuilder alone;
  put(alone, body, inertial);
  (void)alone.build();  // what cannot be a model is refused now, not when the world's is made
  edit();
  drop_left_out();  // its name may be that of a part removed before
  put(edit().builder, body, inertial);
}

void World::remove(const std::string& name) {
  Edit& now = edit();
  const std::vector<Link>& links = now.builder.links();
  bool found = false;
  for (std::size_t i = 1; i < links.size(); ++i) {
    const bool gone = now.left_out.contains(static_cast<int>(i));
    if (gone || !belongs_to(links[i].name, name)) continue;
    now.left_out.insert(static_cast<int>(i));
    found = true;
  }
  if (found) return;
  std::string message = "there is no part '" + name + "' to remove; there are:";
  for (const std::string& known : names()) message += " '" + known + "'";
  throw std::out_of_range(message);
}

std::vector<std::string> World::names() const {
  const Model& model = *core().model;
  std::vector<std::string> found;
  for (std::size_t i = 1; i < model.links().size(); ++i) {
    const Link& link = model.links()[i];
    if (link.parent.value() > 0) continue;
    const std::string name = link.name.substr(0, link.name.find('/'));
    if (std::ranges::find(found, name) == found.end()) found.push_back(name);
  }
  return found;
}

}  // namespace manyhands
