#include "manyhands/model/io/sdf/sdf.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/compose.h"
#include "manyhands/model/hull_mesh.h"
#include "manyhands/model/io/ellipsoid_points.h"
#include "manyhands/model/io/geom_part.h"
#include "manyhands/model/io/missing_inertia.h"
#include "manyhands/model/io/sdf/sdf_parts.h"
#include "manyhands/model/io/sdf/sdf_tree.h"
#include "manyhands/model/io/text_file.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/unit.h"

namespace manyhands {

namespace fs = std::filesystem;

SdfError::SdfError(std::string file, int line, const std::string& message)
    : std::runtime_error(file + ":" + (line > 0 ? std::to_string(line) + ":" : "") + " " + message),
      file_(std::move(file)),
      line_(line) {}

namespace {

using io::SdfElement;
using Pose = Transform<double>;

std::vector<double> floating_configuration(const Pose& X) {
  const Quat<double> r = normalized(to_quat(X.R));
  return {X.p.x, X.p.y, X.p.z, r.x, r.y, r.z, r.w};
}

/// Turns the parts of an SDF model into a model, one part at a time.
class Assembler {
 public:
  Assembler(const io::SdfWorld& world, const io::SdfModel& model, const SdfOptions& options)
      : frames_(world.frames), model_(model), options_(options), builder_(model.name) {
    if (world.gravity) builder_.set_gravity(*world.gravity);
    if (world.time_step) builder_.set_time_step(*world.time_step);
  }

  Model assemble() {
    const io::SdfTree tree = io::find_tree(frames_, model_);
    claim_names();
    for (const io::SdfBranch& branch : tree.branches) add_link(branch);
    for (const io::SdfLoop& loop : tree.loops) close_loop(loop);
    io::give_missing_inertia(builder_, [&](const Link& link, const std::string& done) {
      sources_.at(link.name).note(LoadAction::kRepaired, done);
    });
    for (const io::SdfBranch& branch : tree.branches) {
      const io::SdfLink& link = model_.links[branch.link];
      for (const io::SdfGeom& geom : link.geoms) add_geom(geom, link);
    }
    if (meshes_left_out_ > 0) {
      model_.source.note(LoadAction::kIgnored,
                         std::to_string(meshes_left_out_) + " geoms with meshes left out, as asked");
    }
    const CombineRule friction = options_.bullet ? CombineRule::kProduct : CombineRule::kMinimum;
    const CombineRule restitution = options_.bullet ? CombineRule::kProduct : CombineRule::kMaximum;
    builder_.set_contact_rules(
        {.friction = friction, .restitution = restitution, .self_collision = model_.self_collide});
    return builder_.build();
  }

 private:
  /// Names that the file gives come before those that are made here.
  void claim_names() {
    link_names_.insert("world");
    for (const io::SdfLink& link : model_.links) {
      if (link.name != "world") link_names_.insert(link.name);
    }
    for (const io::SdfJoint& joint : model_.joints) joint_names_.insert(joint.name);
  }

  static std::string free_name(std::set<std::string>& names, std::string name) {
    while (!names.insert(name).second) name += '_';
    return name;
  }

  LinkId new_link(const std::string& name, const SdfElement& source, const Inertial& inertial = {}) {
    sources_.emplace(name, source);
    return builder_.add_link(name, inertial);
  }

  void add_link(const io::SdfBranch& branch) {
    const io::SdfLink& link = model_.links[branch.link];
    std::string name = link.name;
    if (name == "world") {
      name = free_name(link_names_, name);
      link.source.note(LoadAction::kRepaired, "it has the world's name; called " + io::in_quotes(name));
    }
    const Pose X_WL = frames_.pose(link.key);
    X_WL_.emplace(link.key, X_WL);
    if (branch.joint == io::kNone) {
      const LinkId id = links_[link.key] = new_link(name, link.source, link.inertial);
      add_root(link, id, name, X_WL);
    } else {
      const LinkId parent = hang(model_.joints[branch.joint], link, name, X_WL);
      links_.emplace(link.key, parent);
    }
    builder_.link(links_.at(link.key)).gravity_compensation = link.gravity_compensation;
  }

  void add_root(const io::SdfLink& link, LinkId id, const std::string& name, const Pose& X_WL) {
    const bool is_massless = !(link.inertial.mass > 0);
    if (is_massless && !model_.is_static) {
      link.source.note(LoadAction::kRepaired, "a root link without mass cannot float; it stands in the world");
    }
    if (is_massless || model_.is_static) return builder_.place_root(id, X_WL);
    builder_.add_joint({.name = free_name(joint_names_, name + "_free"),
                        .type = JointType::kFloating,
                        .parent = builder_.world(),
                        .child = id,
                        .initial = floating_configuration(X_WL)});
  }

  /// Adds the link, and the joint on which it hangs.
  LinkId hang(const io::SdfJoint& joint, const io::SdfLink& link, const std::string& name, const Pose& X_WL) {
    const std::string parent_key = io::parent_of(frames_, joint);
    const LinkId parent = parent_key.empty() ? builder_.world() : links_.at(parent_key);
    const Pose X_WP = parent_key.empty() ? Pose::identity() : X_WL_.at(parent_key);
    const Pose X_WJ = frames_.pose(joint.key);
    const JointType type = type_of(joint);
    const bool turns = type != JointType::kFixed && type != JointType::kPrismatic;
    constexpr double kNear = 1e-12;  // [m]
    const bool is_at_origin = norm(X_WJ.p - X_WL.p) < kNear;
    // A link's frame is that of its joint. Where the joint turns elsewhere, the link hangs on one without mass there.
    const bool is_direct = !turns || (is_at_origin && joint.axes.size() < 2);
    const Pose X_WF = is_direct ? X_WL : X_WJ;
    Joint first = joint_with(joint, 0, type, X_WF);
    first.parent = parent;
    first.X_PF = inverse(X_WP) * X_WF;
    if (is_direct) {
      first.child = new_link(name, link.source, link.inertial);
      const LinkId id = first.child;
      builder_.add_joint(std::move(first));
      return id;
    }
    LinkId carrier = first.child = new_link(free_name(link_names_, name + "_" + joint.name), joint.source);
    builder_.add_joint(std::move(first));
    if (joint.axes.size() > 1) carrier = add_second(joint, carrier, name, type, X_WF);
    const LinkId id = new_link(name, link.source, link.inertial);
    builder_.add_joint({.name = free_name(joint_names_, name + "_fixed"),
                        .type = JointType::kFixed,
                        .parent = carrier,
                        .child = id,
                        .X_PF = inverse(X_WF) * X_WL});
    return id;
  }

  /// The second axis of a universal joint.
  LinkId add_second(const io::SdfJoint& joint, LinkId carrier, const std::string& name, JointType type,
                    const Pose& X_WF) {
    Joint second = joint_with(joint, 1, type, X_WF);
    second.name = free_name(joint_names_, joint.name + "_2");
    second.parent = carrier;
    const LinkId id = second.child = new_link(free_name(link_names_, name + "_" + joint.name + "_2"), joint.source);
    builder_.add_joint(std::move(second));
    return id;
  }

  [[nodiscard]] JointType type_of(const io::SdfJoint& joint) const {
    if (model_.is_static || joint.type == "fixed") return JointType::kFixed;
    if (joint.type == "ball") return JointType::kSpherical;
    if (joint.type == "prismatic") return JointType::kPrismatic;
    if (joint.type == "screw" || joint.type == "gearbox") {
      joint.source.note_serious(LoadAction::kIgnored, "a " + joint.type + " joint is not known; it is fixed");
      return JointType::kFixed;
    }
    return joint.type == "continuous" ? JointType::kContinuous : JointType::kRevolute;
  }

  /// The k-th axis as a joint whose frame is F; without parent, child and place.
  [[nodiscard]] Joint joint_with(const io::SdfJoint& joint, std::size_t k, JointType type, const Pose& X_WF) const {
    if (type == JointType::kFixed || type == JointType::kSpherical) return {.name = joint.name, .type = type};
    const io::SdfAxis& axis = joint.axes[k];
    Joint result = axis.joint;
    result.name = joint.name;
    result.type = type;
    result.axis = at_unit_length(transpose(X_WF.R) * axis_in_world(joint, axis));
    if (result.mimic && !is_driver(result.mimic->joint, joint)) {
      axis.source.note_serious(LoadAction::kIgnored, "it mimics " + io::in_quotes(result.mimic->joint) +
                                                         ", which is no joint of one axis here; it moves freely");
      result.mimic.reset();
    }
    if (result.mimic) result.mimic->joint = joint.scope.substr(model_.name.size() + 2) + result.mimic->joint;
    return result;
  }

  [[nodiscard]] bool is_driver(const std::string& name, const io::SdfJoint& joint) const {
    return std::ranges::any_of(model_.joints, [&](const io::SdfJoint& other) {
      return other.key == joint.scope + name && !other.axes.empty() && !other.axes[0].joint.mimic &&
             velocity_size(type_of(other)) == 1;
    });
  }

  [[nodiscard]] Vec3<double> axis_in_world(const io::SdfJoint& joint, const io::SdfAxis& axis) const {
    const std::string& in = axis.expressed_in;
    const Pose X_WE = frames_.pose(in.empty() ? joint.key : frames_.find(axis.source, joint.scope, in));
    return at_unit_length(X_WE.R * axis.xyz);
  }

  /// A joint whose child has another one becomes an equality constraint.
  void close_loop(const io::SdfLoop& loop) {
    const io::SdfJoint& joint = model_.joints[loop.joint];
    EqualityConstraint e{.name = joint.name, .link_a = link_at(loop.parent), .link_b = link_at(loop.child)};
    const JointType type = type_of(joint);
    Pose X_WE = frames_.pose(joint.key);
    if (type == JointType::kFixed) {
      e.type = EqualityType::kFixed;
    } else if (type == JointType::kSpherical) {
      e.type = EqualityType::kPoint;
    } else if (joint.axes.size() == 1) {
      e.type = type == JointType::kPrismatic ? EqualityType::kPrismatic : EqualityType::kHinge;
      X_WE.R = rotation_to_normal(axis_in_world(joint, joint.axes[0]));
    } else {
      joint.source.note_serious(LoadAction::kIgnored, "a " + joint.type + " joint cannot close a loop; it is left out");
      return;
    }
    if (e.link_a == e.link_b) return joint.source.note(LoadAction::kIgnored, "it joins a link to itself");
    const auto X_WL = [&](const std::string& key) { return key.empty() ? Pose::identity() : X_WL_.at(key); };
    e.X_LA = inverse(X_WL(loop.parent)) * X_WE;
    e.X_LB = inverse(X_WL(loop.child)) * X_WE;
    joint.source.note(LoadAction::kRepaired,
                      "its child hangs on another joint; this one closes a loop, without limits and friction");
    builder_.add_equality(std::move(e));
  }

  [[nodiscard]] LinkId link_at(const std::string& key) const { return key.empty() ? LinkId(0) : links_.at(key); }

  void add_geom(const io::SdfGeom& part, const io::SdfLink& link) {
    Geom geom = part.geom;
    geom.link = links_.at(link.key);
    geom.X_LG = part.pose.X;
    if (!part.pose.relative_to.empty()) {
      const Pose X_WR = frames_.pose(frames_.find(part.source, link.scope, part.pose.relative_to));
      geom.X_LG = inverse(X_WL_.at(link.key)) * X_WR * part.pose.X;
    }
    if (part.ellipsoid) {
      geom.shape.mesh = builder_.add_mesh(hull_of(io::points_on_ellipsoid(*part.ellipsoid)));
      part.source.note(LoadAction::kRepaired, "the ellipsoid became the hull of 162 points on it");
    }
    if (!part.texture_file.empty()) geom.texture = texture_of(part, part.source.file().paths);
    if (geom.shape.type != ShapeType::kMesh) {
      builder_.add_geom(std::move(geom));
    } else if (options_.load_meshes) {
      const std::string file = local_name(part.mesh_file);
      add_meshes(part, std::move(geom), {part.source.file().paths, file, part.mesh_scale, options_.bullet}, meshes_,
                 builder_);
    } else {
      ++meshes_left_out_;
    }
  }

  /// Bullet's files write "/meshes/part.stl" for what lies in their own folder.
  static std::string local_name(const std::string& uri) {
    std::error_code error;
    return uri.starts_with('/') && !fs::exists(uri, error) ? uri.substr(1) : uri;
  }

  const io::SdfFrames& frames_;
  const io::SdfModel& model_;
  const SdfOptions& options_;
  ModelBuilder builder_;
  std::set<std::string> link_names_, joint_names_;
  std::map<std::string, LinkId> links_;        ///< by key
  std::map<std::string, Pose> X_WL_;           ///< by key, of the links so far
  std::map<std::string, SdfElement> sources_;  ///< by name of the link
  io::MeshShelf meshes_{builder_};
  int meshes_left_out_ = 0;
};

std::string read_text(const fs::path& path) {
  try {
    return io::read_text_file(path);
  } catch (const FileNotFound&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw SdfError(path.string(), 0, std::string(error.what()) + "; expected an SDF file");
  }
}

}  // namespace

std::vector<LoadedModel> load_sdf_string(std::string_view text, const std::string& file, const fs::path& folder,
                                         const SdfOptions& options) {
  io::SdfWorld world;
  io::read_sdf(world, text, file, folder, options);
  std::vector<LoadedModel> loaded;
  for (io::SdfModel& part : world.models) {
    world.notes = &part.report;
    try {
      Model model = Assembler(world, part, options).assemble();
      LoadReport report = loaded.empty() ? std::move(world.report) : LoadReport{};
      report.notes.insert(report.notes.end(), part.report.notes.begin(), part.report.notes.end());
      std::ranges::stable_sort(report.notes, {}, [](const LoadNote& n) { return std::pair(n.file, n.line); });
      loaded.push_back({std::move(model), std::move(report)});
    } catch (const ModelError& error) {
      part.source.fail(error.what());
    }
  }
  return loaded;
}

std::vector<LoadedModel> load_sdf(const fs::path& path, const SdfOptions& options) {
  return load_sdf_string(read_text(path), path.string(), fs::absolute(path).parent_path(), options);
}

LoadedModel joined(std::vector<LoadedModel> models) {
  if (models.size() == 1) return std::move(models[0]);
  ModelBuilder builder("world");
  LoadReport report;
  ContactRules rules{.self_collision = false};
  std::set<std::string> names;
  for (const LoadedModel& loaded : models) {
    const bool self = rules.self_collision || loaded.model.contact_rules().self_collision;
    rules = loaded.model.contact_rules();
    rules.self_collision = self;
  }
  for (LoadedModel& loaded : models) {
    std::string name = loaded.model.name();
    std::ranges::replace(name, '/', '_');  // what stands before the first one is the model's name
    while (!names.insert(name).second) name += '_';
    const PartMap map = append(builder, loaded.model, {.prefix = name + "/"});
    if (rules.self_collision && !loaded.model.contact_rules().self_collision) {
      exclude_self_collision(builder, loaded.model, map);
    }
    builder.set_gravity(loaded.model.gravity());
    if (loaded.model.time_step()) builder.set_time_step(*loaded.model.time_step());
    std::ranges::move(loaded.report.notes, std::back_inserter(report.notes));
  }
  builder.set_contact_rules(rules);
  return {builder.build(), std::move(report)};
}

}  // namespace manyhands
