#include "manyhands/model/io/urdf/urdf.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "manyhands/model/io/geom_part.h"
#include "manyhands/model/io/missing_inertia.h"
#include "manyhands/model/io/package_paths.h"
#include "manyhands/model/io/text_file.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/io/urdf/urdf_parts.h"
#include "manyhands/model/io/urdf/urdf_tree.h"
#include "manyhands/model/model_builder.h"

namespace manyhands {

namespace fs = std::filesystem;

UrdfError::UrdfError(std::string file, int line, const std::string& message)
    : std::runtime_error(file + ":" + (line > 0 ? std::to_string(line) + ":" : "") + " " + message),
      file_(std::move(file)),
      line_(line) {}

namespace {

using io::UrdfElement;

/// Turns the parts of a URDF into a model, one part at a time.
class Assembler {
 public:
  Assembler(const io::UrdfRobot& robot, const io::UrdfSource& source, const fs::path& folder,
            const UrdfOptions& options)
      : robot_(robot),
        source_(source),
        options_(options),
        paths_(folder, options.package_paths, options.allow_outside_package, options.bullet),
        builder_(robot.name) {}

  Model assemble() {
    const io::UrdfTree found = io::find_tree(robot_), tree = options_.file_order ? io::in_file_order(found) : found;
    add_root(robot_.links[tree.root]);
    for (const io::UrdfBranch& branch : tree.branches) add_branch(branch);
    io::give_missing_inertia(builder_, [&](const Link& link, const std::string& done) {
      elements_.at(link.name).note(LoadAction::kRepaired, done);
    });
    for (const std::size_t index : tree.depth_first()) {
      for (const io::UrdfGeom& geom : robot_.links[index].geoms) add_geom(geom, ids_.at(robot_.links[index].name));
    }
    note_meshes_left_out();
    builder_.set_contact_rules({.friction = CombineRule::kProduct,
                                .restitution = CombineRule::kProduct,
                                .self_collision = options_.self_collision});
    return builder_.build();
  }

 private:
  void add_root(const io::UrdfLink& link) {
    if (options_.bullet) return add_bullet_root(link);
    elements_.emplace(link.name, link.source);
    if (link.name == "world") {
      ids_[link.name] = builder_.world();
      if (!options_.fixed_base) link.source.note(LoadAction::kIgnored, "the root link is the world and cannot float");
      return;
    }
    const LinkId id = new_link(link);
    if (options_.fixed_base) return builder_.place_root(id, options_.base_pose);
    let_float(id);
  }

  /// In Bullet a root called "world" is a link like others, and one without mass stands.
  void add_bullet_root(const io::UrdfLink& link) {
    const LinkId id = new_link(link);
    if (options_.fixed_base || !(link.inertial.mass > 0)) return builder_.place_root(id, options_.base_pose);
    let_float(id);
  }

  void let_float(LinkId id) {
    Joint joint{.name = "root_joint", .type = JointType::kFloating, .parent = builder_.world(), .child = id};
    const auto taken = [&](const io::UrdfJoint& other) { return other.joint.name == joint.name; };
    while (std::ranges::any_of(robot_.joints, taken)) joint.name += '_';
    builder_.add_joint(joint);
  }

  LinkId new_link(const io::UrdfLink& link) {
    std::string name = link.name;
    const auto taken = [&](const io::UrdfLink& other) { return other.name == name; };
    if (name == "world") {
      while (std::ranges::any_of(robot_.links, taken)) name += '_';
      link.source.note(LoadAction::kRepaired, "it has the world's name; called " + io::in_quotes(name));
    }
    elements_.emplace(name, link.source);
    Inertial inertial = link.inertial;
    inertial.com = options_.scale * inertial.com;
    const LinkId id = ids_[link.name] = builder_.add_link(name, inertial);
    builder_.link(id).inertial_axes = link.inertial_axes;
    builder_.link(id).inertia_scale = link.inertia_scale;
    return id;
  }

  void add_branch(const io::UrdfBranch& branch) {
    const io::UrdfLink& link = robot_.links[branch.link];
    const io::UrdfJoint& joint = robot_.joints[branch.joint];
    if (link.name == "world" && !options_.bullet) {
      link.source.fail("only the root link may be called 'world'; expected another name");
    }
    const LinkId id = new_link(link);
    Joint added = joint.joint;
    added.X_PF.p = options_.scale * added.X_PF.p;
    if (added.type == JointType::kPrismatic) {
      added.limits.lower *= options_.scale;
      added.limits.upper *= options_.scale;
    }
    added.parent = ids_.at(joint.parent);
    added.child = id;
    builder_.add_joint(std::move(added));
  }

  void add_geom(const io::UrdfGeom& part, LinkId link) {
    Geom geom = part.geom;
    geom.link = link;
    geom.X_LG.p = options_.scale * geom.X_LG.p;
    geom.shape.size = options_.scale * geom.shape.size;
    if (!part.texture_file.empty()) geom.texture = texture_of(part, paths_);
    if (geom.shape.type != ShapeType::kMesh) {
      builder_.add_geom(std::move(geom));
    } else if (options_.load_meshes) {
      const Vec3<double> scale = options_.scale * part.mesh_scale;
      add_meshes(part, std::move(geom), {paths_, part.mesh_file, scale, options_.bullet}, meshes_, builder_);
    } else {
      ++meshes_left_out_;
    }
  }

  void note_meshes_left_out() {
    if (meshes_left_out_ == 0) return;
    source_.report.notes.push_back({LoadAction::kIgnored, source_.file, 0, "robot '" + robot_.name + "'",
                                    std::to_string(meshes_left_out_) + " geoms with meshes left out, as asked"});
  }

  const io::UrdfRobot& robot_;
  const io::UrdfSource& source_;
  const UrdfOptions& options_;
  io::PackagePaths paths_;
  ModelBuilder builder_;
  std::map<std::string, LinkId> ids_;
  std::map<std::string, UrdfElement> elements_;
  io::MeshShelf meshes_{builder_};
  int meshes_left_out_ = 0;
};

io::XmlFile parse_xml(std::string_view text, const std::string& file) {
  try {
    return io::XmlFile(text);
  } catch (const io::XmlError& error) {
    throw UrdfError(file, error.line(), error.what());
  }
}

std::string read_text(const fs::path& path) {
  try {
    return io::read_text_file(path);
  } catch (const FileNotFound&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw UrdfError(path.string(), 0, std::string(error.what()) + "; expected a URDF file");
  }
}

}  // namespace

LoadedModel load_urdf_string(std::string_view text, const std::string& file, const fs::path& folder,
                             const UrdfOptions& options) {
  if (!(std::isfinite(options.scale) && options.scale > 0)) throw UrdfError(file, 0, "scale is not above 0");
  const io::XmlFile xml = parse_xml(text, file);
  LoadReport report;
  io::UrdfSource source{file, xml, report, options.bullet};
  const UrdfElement root(source, xml.root(), "robot");
  if (root.tag() != "robot") {
    root.fail("the root element is <" + std::string(root.tag()) + ">; expected <robot name=\"...\">");
  }
  const io::UrdfRobot robot = io::read_robot(root);
  try {
    Model model = Assembler(robot, source, folder, options).assemble();
    std::ranges::stable_sort(report.notes, {}, &LoadNote::line);
    return {std::move(model), std::move(report)};
  } catch (const ModelError& error) {
    throw UrdfError(file, root.line(), error.what());
  }
}

LoadedModel load_urdf(const fs::path& path, const UrdfOptions& options) {
  return load_urdf_string(read_text(path), path.string(), fs::absolute(path).parent_path(), options);
}

}  // namespace manyhands
