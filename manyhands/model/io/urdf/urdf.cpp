#include "manyhands/model/io/urdf/urdf.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "manyhands/model/io/mesh/mesh_file.h"
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
        paths_(folder, options.package_paths, options.allow_outside_package),
        builder_(robot.name) {}

  Model assemble() {
    const io::UrdfTree tree = io::find_tree(robot_);
    add_root(robot_.links[tree.root]);
    for (const io::UrdfBranch& branch : tree.branches) add_branch(branch);
    give_inertia_where_needed();
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
    elements_.emplace(link.name, link.source);
    if (link.name == "world") {
      ids_[link.name] = builder_.world();
      if (!options_.fixed_base) link.source.note(LoadAction::kIgnored, "the root link is the world and cannot float");
      return;
    }
    const LinkId id = ids_[link.name] = builder_.add_link(link.name, link.inertial);
    if (options_.fixed_base) {
      builder_.place_root(id, options_.base_pose);
      return;
    }
    Joint joint{.name = "root_joint", .type = JointType::kFloating, .parent = builder_.world(), .child = id};
    const auto taken = [&](const io::UrdfJoint& other) { return other.joint.name == joint.name; };
    while (std::ranges::any_of(robot_.joints, taken)) joint.name += '_';
    builder_.add_joint(joint);
  }

  void add_branch(const io::UrdfBranch& branch) {
    const io::UrdfLink& link = robot_.links[branch.link];
    const io::UrdfJoint& joint = robot_.joints[branch.joint];
    elements_.emplace(link.name, link.source);
    if (link.name == "world") link.source.fail("only the root link may be called 'world'; expected another name");
    const LinkId id = ids_[link.name] = builder_.add_link(link.name, link.inertial);
    Joint added = joint.joint;
    added.parent = ids_.at(joint.parent);
    added.child = id;
    builder_.add_joint(std::move(added));
  }

  /// Joints that move no inertia: the outermost get what is missing, which serves those nearer the root as well.
  void give_inertia_where_needed() {
    constexpr int kMostPasses = 8;  // two do, unless numbers are so large that rounding eats what was given
    for (int pass = 0; pass < kMostPasses; ++pass) {
      const std::vector<JointId> found = builder_.joints_without_inertia();
      if (found.empty()) return;
      const std::set<JointId> lacking(found.begin(), found.end());
      std::vector<bool> is_served(builder_.links().size(), false);  // a link beyond this one was given inertia
      for (std::size_t i = is_served.size() - 1; i > 0; --i) {
        const Link& link = builder_.links()[i];
        const bool lacks = lacking.contains(link.joint);
        if (lacks && !is_served[i]) give_inertia(builder_.joint(link.joint));
        if ((lacks || is_served[i]) && link.parent.is_valid()) is_served[link.parent.index()] = true;
      }
    }
  }

  void give_inertia(Joint& joint) {
    constexpr double kMass = 1e-3;            // [kg]
    constexpr double kInertia = 1e-6;         // [kg m^2]
    constexpr double kShareOfLargest = 1e-3;  // of a needle, about its axis: what a thin rod has
    Link& link = builder_.link(joint.child);
    const UrdfElement& element = elements_.at(link.name);
    if (joint.parent == builder_.world() && joint.type == JointType::kFloating && joint.child == LinkId(1) &&
        link.inertial.mass <= 0) {
      joint.type = JointType::kFixed;
      element.note(LoadAction::kRepaired, "the root link has no mass and cannot float; it is fixed to the world");
      return;
    }
    Inertial& inertial = link.inertial;
    std::string given;
    if (inertial.mass < kMass) {
      inertial.mass = kMass;
      given = "a mass of " + io::format_number(kMass) + " kg and ";
    }
    SymMat3<double>& I = inertial.inertia;
    const double added = std::max(kInertia, kShareOfLargest * std::max({I.xx, I.yy, I.zz}));
    I = I + SymMat3<double>{added, added, added, 0, 0, 0};
    element.note(LoadAction::kRepaired, "joint '" + joint.name + "' would move no inertia; " + given +
                                            "an inertia of " + io::format_number(added) + " kg m^2 given to the link");
  }

  void add_geom(const io::UrdfGeom& part, LinkId link) {
    Geom geom = part.geom;
    geom.link = link;
    if (geom.shape.type == ShapeType::kMesh) {
      if (!options_.load_meshes) {
        ++meshes_left_out_;
        return;
      }
      geom.shape.mesh = mesh_of(part);
      if (!geom.shape.mesh.is_valid()) return;
    }
    if (!part.texture_file.empty()) geom.texture = texture_of(part);
    builder_.add_geom(std::move(geom));
  }

  /// The mesh of a geom, loaded once for all that use it; an invalid id, which is noted, if it cannot be read.
  MeshId mesh_of(const io::UrdfGeom& part) {
    const Vec3<double>& s = part.mesh_scale;
    const auto [entry, is_new] = meshes_.try_emplace(std::tuple(part.mesh_file, s.x, s.y, s.z));
    LoadedMesh& mesh = entry->second;
    if (is_new) {
      try {
        mesh.id = builder_.add_mesh(load_mesh(paths_.resolve(part.mesh_file), s));
      } catch (const io::PathEscape& error) {
        part.source.fail("mesh " + io::in_quotes(part.mesh_file) + ": " + error.what());
      } catch (const std::exception& error) {
        mesh.problem = error.what();
      }
    }
    if (!mesh.id.is_valid()) {
      part.source.note_serious(LoadAction::kIgnored, "mesh " + io::in_quotes(part.mesh_file) + ": " + mesh.problem +
                                                         "; the geom is left out");
    }
    return mesh.id;
  }

  /// Nothing, which is noted, if there is no such file that may be read.
  std::optional<GeomTexture> texture_of(const io::UrdfGeom& part) const {
    try {
      return GeomTexture{.file = paths_.resolve(part.texture_file).string()};
    } catch (const std::runtime_error& error) {
      part.source.note(LoadAction::kIgnored, "texture " + io::in_quotes(part.texture_file) + ": " + error.what() +
                                                 "; the colour alone is shown");
      return std::nullopt;
    }
  }

  void note_meshes_left_out() {
    if (meshes_left_out_ == 0) return;
    source_.report.notes.push_back({LoadAction::kIgnored, source_.file, 0, "robot '" + robot_.name + "'",
                                    std::to_string(meshes_left_out_) + " geoms with meshes left out, as asked"});
  }

  struct LoadedMesh {
    MeshId id;
    std::string problem;
  };

  const io::UrdfRobot& robot_;
  const io::UrdfSource& source_;
  const UrdfOptions& options_;
  io::PackagePaths paths_;
  ModelBuilder builder_;
  std::map<std::string, LinkId> ids_;
  std::map<std::string, UrdfElement> elements_;
  std::map<std::tuple<std::string, double, double, double>, LoadedMesh> meshes_;
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
  const io::XmlFile xml = parse_xml(text, file);
  LoadReport report;
  io::UrdfSource source{file, xml, report};
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
