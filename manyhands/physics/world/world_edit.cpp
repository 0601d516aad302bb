// World: adding and removing parts.
#include <algorithm>
#include <fstream>
#include <set>

#include "manyhands/base/float_environment.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/model/hull_mesh.h"
#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/model/io/sdf/sdf.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/model/part_checks.h"
#include "manyhands/model/solids.h"
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

namespace {

/// By the root element, or what stands for it near the file's beginning.
LoadedModel load_any(const std::filesystem::path& path, bool allow_outside_package,
                     MjcfCompliance compliance = MjcfCompliance::kStated) {
  if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path)) {
    throw std::invalid_argument(path.string() + " is a folder, a pipe or the like; expected a URDF, MJCF or SDF file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileNotFound(path);
  std::string head(1 << 16, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  const std::size_t mjcf = head.find("<mujoco"), robot = head.find("<robot"), sdf = head.find("<sdf");
  if (path.extension() == ".sdf" || sdf < std::min(mjcf, robot)) {
    return joined(load_sdf(path, {.allow_outside_package = allow_outside_package}));
  }
  const bool is_urdf = path.extension() == ".urdf" || robot < mjcf;
  if (is_urdf) return load_urdf(path, {.allow_outside_package = allow_outside_package});
  return load_mjcf(path, {.allow_outside_package = allow_outside_package, .compliance = compliance});
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
  check_restitution(what, s.restitution);
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

World World::from_file(const std::filesystem::path& path, std::optional<double> time_step, Integrator integrator,
                       bool allow_outside_package, MjcfCompliance compliance) {
  LoadedModel loaded = load_any(path, allow_outside_package, compliance);
  const double h = time_step.value_or(loaded.model.time_step().value_or(0.002));
  World world(std::make_shared<const Model>(std::move(loaded.model)), h, integrator);
  world.report_ = std::move(loaded.report);
  return world;
}

/// Makes the core anew, without the links that were removed and with others where they were put.
void World::rebuild() const {
  const FloatEnvironment floats;
  const WorldCore& old = *core_;
  std::vector<std::uint8_t> gone = old.gone();
  gone.resize(old.model->links().size(), 0);
  ModelBuilder builder(old.model->name());
  const PartMap map = append(builder, *old.model, {.left_out = gone});
  take_settings(*old.model, builder);
  for (const auto& [link, X_WL] : old.new_places) {
    if (map.links[link.index()] >= 0) builder.place_root(LinkId(map.links[link.index()]), X_WL);
  }
  auto next = std::make_unique<WorldCore>(builder.build());
  carry(old, map, *next);
  core_ = std::move(next);
  ++edition_;
}

void World::add(const Model& model, const Transform<double>& X_WM, const std::string& name) {
  const FloatEnvironment floats;
  internal::require_pose("the model's place", X_WM);
  WorldCore& now = loose();
  const int links = static_cast<int>(now.model->links().size());
  const ContactRules theirs = model.contact_rules();
  ContactRules rules = now.num_geoms() == 0 ? theirs : now.model->contact_rules();
  const bool restrained = theirs.self_collision && !rules.self_collision;  // what was there before
  ModelBuilder part("world");
  const PartMap map = append(part, model, {.X_WM = X_WM, .prefix = name.empty() ? "" : name + "/"});
  if (!theirs.self_collision && rules.self_collision) exclude_self_collision(part, model, map);
  rules.self_collision = rules.self_collision || theirs.self_collision;
  now.insert(part.build(), rules);
  if (restrained) {
    for (const auto& [a, b] : self_collisions(*now.model)) {
      if (a.value() < links && b.value() < links) now.set_excluded(a, b, true);
    }
  }
}

void World::add_file(const std::filesystem::path& path, const Transform<double>& X_WM, const std::string& name,
                     bool allow_outside_package) {
  LoadedModel loaded = load_any(path, allow_outside_package);
  add(loaded.model, X_WM, name);
  report_.notes.insert(report_.notes.end(), loaded.report.notes.begin(), loaded.report.notes.end());
}

void World::add_body(const NewBody& body) {
  const FloatEnvironment floats;
  check_body(body);
  ModelBuilder part("world");
  put(part, body, body.fixed ? Inertial{} : solid(body));
  WorldCore& now = loose();
  now.insert(part.build(), now.model->contact_rules());
}

void World::remove(const std::string& name) {
  WorldCore& now = loose();
  std::vector<LinkId> found = now.model->find_links(name);
  std::erase(found, LinkId(0));
  if (found.empty()) {
    std::string message = "there is no part '" + name + "' to remove; there are:";
    for (const std::string& known : names()) message += " '" + known + "'";
    throw std::out_of_range(message);
  }
  while (!found.empty()) {
    const LinkId link = found.back();
    found.pop_back();
    if (now.is_gone(link)) continue;
    const std::span<const LinkId> children = now.model->children_of(link);
    found.insert(found.end(), children.begin(), children.end());
    now.remove(link);
  }
  // A tendon that has lost a part is none, and neither is what gives way.
  if (2 * now.num_gone > now.model->links().size() || !now.system.tree.is_plain()) rebuild();
}

std::vector<std::string> World::names() const {
  const Model& model = *loose().model;
  std::vector<std::string> found;
  std::set<std::string, std::less<>> known;
  for (const LinkId id : model.children_of(LinkId(0))) {
    const std::string& link = model.link(id).name;
    const std::string name = link.substr(0, link.find('/'));
    if (!name.empty() && known.insert(name).second) found.push_back(name);
  }
  return found;
}

void World::set_collision(const std::string& a, const std::string& b, bool enabled) {
  WorldCore& now = loose();
  const auto named = [&](const std::string& name) {
    std::vector<LinkId> links = now.model->find_links(name);
    if (links.empty()) (void)now.model->link_id(name);
    return links;
  };
  const std::vector<LinkId> links_a = named(a), links_b = named(b);
  for (const LinkId i : links_a) {
    for (const LinkId j : links_b) {
      if (i != j) now.set_excluded(i, j, !enabled);
    }
  }
}

}  // namespace manyhands
