// Saves a model as URDF: one tree of links, their masses, shapes and surfaces.
#include <algorithm>
#include <cmath>
#include <set>

#include "manyhands/model/io/save/asset_files.h"
#include "manyhands/model/io/save/save_notes.h"
#include "manyhands/model/io/save/xml_out.h"

namespace manyhands {

namespace io {

namespace {

using Pose = Transform<double>;

bool is_identity(const Pose& X) { return same(X.R, Mat3<double>::identity()) && same(X.p, Vec3<double>::zero()); }

class UrdfWriter {
 public:
  UrdfWriter(const Model& model, SaveNotes& notes, AssetFiles* files)
      : model_(model), notes_(notes), files_(files), robot_(document_.append_child("robot")) {}

  std::string write() {
    require_text(model_.name());
    set(robot_, "name", model_.name().empty() ? "robot" : model_.name());
    choose_root();
    for (std::size_t i = has_world_ ? 0 : 1; i < model_.links().size(); ++i) {
      if (!model_.links()[i].name.empty()) write_link(LinkId(i));
    }
    for (std::size_t i = 1; i < model_.links().size(); ++i) {
      const Link& link = model_.links()[i];
      if (!link.name.empty() && !link.joint.is_valid() && has_world_) weld_root(LinkId(i));
    }
    find_mimics();
    for (std::size_t i = 0; i < model_.joints().size(); ++i) {
      const Joint& joint = model_.joints()[i];
      if (!joint.name.empty() && (has_world_ || joint.parent != LinkId(0))) write_joint(JointId(i));
    }
    note_left_out();
    return text_of(document_);
  }

 private:
  /// A single link on the world, standing at its origin or floating, is the root of the file. Else that is a link
  /// "world", from which all others come.
  void choose_root() {
    std::vector<LinkId> roots;
    for (std::size_t i = 1; i < model_.links().size(); ++i) {
      const Link& link = model_.links()[i];
      if (!link.name.empty() && link.parent == LinkId(0)) roots.emplace_back(i);
    }
    const auto is_plain = [&](LinkId id) {
      const Link& link = model_.link(id);
      if (!link.joint.is_valid()) return is_identity(link.X_BL);
      const Joint& joint = model_.joint(link.joint);
      return joint.type == JointType::kFloating && is_identity(joint.X_PF);
    };
    has_world_ = roots.size() != 1 || !is_plain(roots[0]) || !model_.geoms_of(LinkId(0)).empty();
    if (has_world_ || !model_.link(roots[0]).joint.is_valid()) return;
    notes_.changed(part("joint", model_.joint(model_.link(roots[0]).joint).name),
                   "the root floats where the file is loaded so (fixed_base=False), by 'root_joint'");
  }

  void write_origin(pugi::xml_node node, const Pose& X) {
    if (is_identity(X)) return;
    pugi::xml_node origin = node.append_child("origin");
    set(origin, "xyz", X.p);
    const Vec3<double> rpy = rpy_for(X.R);
    if (!same(rpy, Vec3<double>::zero())) set(origin, "rpy", rpy);
  }

  void write_link(LinkId id) {
    const Link& link = model_.link(id);
    pugi::xml_node node = robot_.append_child("link");
    set(node, "name", names_.claim("link", link.name, "link", notes_));
    if (link.gravity_compensation != 0) {
      notes_.loss(LoadAction::kIgnored, part("link", link.name), "its gravity compensation is left out");
    }
    const Inertial& inertial = link.inertial;
    const SymMat3<double>& I = inertial.inertia;
    if (id != LinkId(0)) {  // of mass 0 too: PyBullet takes 1 kg where a link has none
      pugi::xml_node own = node.append_child("inertial");
      write_origin(own, {Mat3<double>::identity(), inertial.com});
      set(own.append_child("mass"), "value", inertial.mass);
      pugi::xml_node inertia = own.append_child("inertia");
      set(inertia, "ixx", I.xx);
      set(inertia, "ixy", I.xy);
      set(inertia, "ixz", I.xz);
      set(inertia, "iyy", I.yy);
      set(inertia, "iyz", I.yz);
      set(inertia, "izz", I.zz);
    }
    for (const GeomId geom : model_.geoms_of(id)) write_geom(node, model_.geoms()[geom.index()]);
    write_surface(node, id);
  }

  /// One surface for all shapes of a link: PyBullet's <contact>.
  void write_surface(pugi::xml_node link, LinkId id) {
    const SurfaceMaterial* surface = nullptr;
    for (const GeomId geom_id : model_.geoms_of(id)) {
      const Geom& geom = model_.geoms()[geom_id.index()];
      if (geom.role != GeomRole::kCollision) continue;
      const std::string what = part("geom", geom.name) + " of " + part("link", model_.link(id).name);
      if (surface != nullptr && surface->fields() != geom.surface.fields()) {
        notes_.loss(LoadAction::kRepaired, what, "a link has one surface in URDF; that of its first geom");
      }
      if (surface == nullptr) surface = &geom.surface;
      if (geom.surface.compliance) notes_.loss(LoadAction::kIgnored, what, "its compliance is left out");
      if (geom.margin != 0) notes_.loss(LoadAction::kIgnored, what, "its margin is left out");
      const bool has_filter = geom.filter.group != 1 || (geom.filter.mask & 1) == 0;
      if (has_filter) notes_.loss(LoadAction::kIgnored, what, "its filter of contact is left out");
    }
    if (surface == nullptr || surface->fields() == SurfaceMaterial().fields()) return;
    if (surface->friction_y) {
      notes_.loss(LoadAction::kIgnored, part("link", model_.link(id).name), "its friction differs by direction");
    }
    pugi::xml_node contact = link.append_child("contact");
    const auto add = [&](const char* tag, double value) { set(contact.append_child(tag), "value", value); };
    add("lateral_friction", surface->lateral_friction);
    add("spinning_friction", surface->spinning_friction);
    add("rolling_friction", surface->rolling_friction);
    add("restitution", surface->restitution);
    if (surface->stiffness) add("stiffness", *surface->stiffness);
    if (surface->damping) add("damping", *surface->damping);
  }

  void write_geom(pugi::xml_node link, const Geom& geom) {
    const bool is_visual = geom.role == GeomRole::kVisual;
    const std::string what = part("geom", geom.name) + " of " + part("link", model_.link(geom.link).name);
    const bool is_flat = geom.shape.type == ShapeType::kPlane || geom.shape.type == ShapeType::kHeightField;
    const bool is_mesh = geom.shape.type == ShapeType::kMesh || geom.shape.type == ShapeType::kConvex;
    if (is_flat || (is_mesh && files_ == nullptr)) {
      const char* const reason = is_flat ? "URDF has no planes and height fields" : "a text holds no meshes";
      if (is_visual) return notes_.left_out(what, reason);
      return notes_.loss(LoadAction::kIgnored, what, reason);
    }
    pugi::xml_node node = link.append_child(is_visual ? "visual" : "collision");
    require_text(geom.name);
    if (!geom.name.empty()) set(node, "name", geom.name);
    write_origin(node, geom.X_LG);
    write_shape(node.append_child("geometry"), geom.shape);
    if (is_visual) write_material(node, geom);
  }

  void write_shape(pugi::xml_node geometry, const Shape& shape) {
    const Vec3<double>& s = shape.size;
    if (shape.type == ShapeType::kSphere) {
      set(geometry.append_child("sphere"), "radius", s.x);
    } else if (shape.type == ShapeType::kBox) {
      set(geometry.append_child("box"), "size", 2.0 * s);
    } else if (shape.type == ShapeType::kCapsule || shape.type == ShapeType::kCylinder) {
      pugi::xml_node node = geometry.append_child(shape.type == ShapeType::kCapsule ? "capsule" : "cylinder");
      set(node, "radius", s.x);
      set(node, "length", 2 * s.y);
    } else {
      const Mesh& mesh = model_.meshes()[shape.mesh.index()];
      set(geometry.append_child("mesh"), "filename", files_->add(mesh_stem(mesh), ".obj", obj_text(mesh)));
    }
  }

  void write_material(pugi::xml_node visual, const Geom& geom) {
    pugi::xml_node material = visual.append_child("material");
    set(material, "name", "material_" + std::to_string(num_materials_++));
    std::string rgba;
    for (const float x : geom.rgba) rgba += (rgba.empty() ? "" : " ") + exact_text(x);
    set(material.append_child("color"), "rgba", rgba);
    if (!geom.texture) return;
    try {
      if (files_ == nullptr || geom.texture->file.empty()) throw SaveError("URDF shows image files only");
      const std::filesystem::path path(geom.texture->file);
      const std::string stem = file_stem(path.stem().string(), "texture");
      const std::string name = files_->add(stem, path.extension().string(), read_asset(path));
      set(material.append_child("texture"), "filename", name);
    } catch (const SaveError& error) {
      notes_.left_out(part("geom", geom.name), std::string("its texture: ") + error.what());
    }
  }

  void weld_root(LinkId id) {
    const Link& link = model_.link(id);
    pugi::xml_node node = robot_.append_child("joint");
    set(node, "name", names_.claim("joint", link.name + "_fixed", "joint", notes_));
    set(node, "type", "fixed");
    write_origin(node, link.X_BL);
    set(node.append_child("parent"), "link", model_.link(LinkId(0)).name);
    set(node.append_child("child"), "link", link.name);
    notes_.changed_alike("root", part("link", link.name), "it stands in the world; fixed there by a joint");
  }

  /// Joint equalities are mimics; a joint has one.
  void find_mimics() {
    for (const EqualityConstraint& e : model_.equalities()) {
      const bool is_mimic =
          e.type == EqualityType::kJoint && !std::isfinite(e.max_force) && mimics_.emplace(e.joint_b, &e).second;
      if (!is_mimic) notes_.loss(LoadAction::kIgnored, part("equality", e.name), "loops and gears are left out");
    }
  }

  void write_joint(JointId id) {
    const Joint& joint = model_.joint(id);
    const std::string what = part("joint", joint.name);
    pugi::xml_node node = robot_.append_child("joint");
    set(node, "name", names_.claim("joint", joint.name, "joint", notes_));
    const bool is_mocap = joint.type == JointType::kMocap;
    set(node, "type", is_mocap ? "fixed" : to_string(joint.type));
    write_origin(node, joint.X_PF);
    set(node.append_child("parent"), "link", model_.link(joint.parent).name);
    set(node.append_child("child"), "link", model_.link(joint.child).name);
    if (is_mocap)
      notes_.loss(LoadAction::kRepaired, what, "a mocap body, which nobody moves in URDF; fixed where it is");
    if (is_mocap || joint.type == JointType::kFixed) return;
    if (joint.stiffness != 0) notes_.loss(LoadAction::kIgnored, what, "its spring is left out");
    if (joint.type == JointType::kSpherical || joint.type == JointType::kFloating || joint.type == JointType::kPlanar) {
      notes_.loss(LoadAction::kRepaired, what,
                  std::string("a ") + to_string(joint.type) + " joint, which few readers of URDF move");
    }
    if (joint.armature != 0) notes_.loss(LoadAction::kIgnored, what, "its armature is left out");
    if (std::ranges::any_of(joint.initial, [](double x) { return x != 0; })) {
      notes_.left_out(what, "where it starts is left out");
    }
    if (joint.type != JointType::kSpherical && joint.type != JointType::kFloating) {
      set(node.append_child("axis"), "xyz", joint.axis);
    }
    write_limit(node, joint);
    if (joint.damping != 0 || joint.friction != 0) {
      pugi::xml_node dynamics = node.append_child("dynamics");
      set(dynamics, "damping", joint.damping);
      set(dynamics, "friction", joint.friction);
    }
    if (const auto mimic = mimics_.find(id); mimic != mimics_.end()) {
      pugi::xml_node element = node.append_child("mimic");
      set(element, "joint", model_.joint(mimic->second->joint_a).name);
      set(element, "multiplier", mimic->second->ratio);
      set(element, "offset", mimic->second->offset);
    }
  }

  /// URDF's revolute and prismatic joints have all four numbers; what is unlimited gets a number that nothing reaches.
  void write_limit(pugi::xml_node node, const Joint& joint) {
    constexpr double kUnlimited = 1e10;
    const JointLimits& limits = joint.limits;
    const bool has_range = joint.type == JointType::kRevolute || joint.type == JointType::kPrismatic;
    if (!has_range && !std::isfinite(limits.effort) && !std::isfinite(limits.velocity)) return;
    pugi::xml_node limit = node.append_child("limit");
    if (has_range && limits.compliance)
      notes_.loss(LoadAction::kIgnored, part("joint", joint.name), "the compliance of its limits is left out");
    if (has_range) {
      set(limit, "lower", std::max(limits.lower, -kUnlimited));
      set(limit, "upper", std::min(limits.upper, kUnlimited));
    }
    set(limit, "effort", std::min(limits.effort, kUnlimited));
    set(limit, "velocity", std::min(limits.velocity, kUnlimited));
  }

  void note_left_out() {
    const auto left_out = [&](std::size_t count, const char* what) {
      if (count > 0) notes_.left_out("robot", std::to_string(count) + " " + what + " left out: URDF has none");
    };
    for (const Tendon& tendon : model_.tendons())
      notes_.loss(LoadAction::kIgnored, part("tendon", tendon.name), "it is left out");
    for (const Actuator& actuator : model_.actuators()) {
      if (!actuator.name.empty()) notes_.loss(LoadAction::kIgnored, part("actuator", actuator.name), "it is left out");
    }
    left_out(model_.keyframes().size(), "keyframes");
    left_out(model_.frames().size() - model_.links().size(), "frames without a link");
    const std::size_t rules = model_.contact_pairs().size() + model_.exclusions().size();
    if (rules > 0) {
      notes_.loss(LoadAction::kIgnored, "contact", std::to_string(rules) + " pairs and exclusions are left out");
    }
    notes_.left_out("robot", "gravity, time step and the rules of contact are the reader's own");
  }

  const Model& model_;
  SaveNotes& notes_;
  AssetFiles* files_;
  pugi::xml_document document_;
  pugi::xml_node robot_;
  SavedNames names_;
  bool has_world_ = false;
  int num_materials_ = 0;
  std::map<JointId, const EqualityConstraint*> mimics_;
};

SavedText saved_urdf(const Model& model, const std::string& file, AssetFiles* files, const SaveOptions& options) {
  SaveNotes notes(file, "URDF");
  std::string text = UrdfWriter(model, notes, files).write();
  return {std::move(text), notes.take(options)};
}

}  // namespace

}  // namespace io

LoadReport save_urdf(const Model& model, const std::filesystem::path& path, const SaveOptions& options) {
  return io::save_with_assets(
      path, [&](io::AssetFiles& files) { return io::saved_urdf(model, path.string(), &files, options); });
}

SavedText save_urdf_string(const Model& model, const SaveOptions& options) {
  return io::saved_urdf(model, "urdf", nullptr, options);
}

}  // namespace manyhands
