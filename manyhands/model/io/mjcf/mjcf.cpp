#include "manyhands/model/io/mjcf/mjcf.h"

#include <set>

#include "manyhands/model/io/mjcf/mjcf_scene.h"
#include "manyhands/model/io/text_file.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands {

namespace fs = std::filesystem;

MjcfError::MjcfError(std::string file, int line, const std::string& message)
    : std::runtime_error(file + ":" + (line > 0 ? std::to_string(line) + ":" : "") + " " + message),
      file_(std::move(file)),
      line_(line) {}

namespace io {

namespace {

template <class Parts, class Names>
const auto& find_part(const Parts& parts, const Names& names, const MjcfElement& user, const char* attribute,
                      const char* kind) {
  const std::string name = user.text(attribute);
  const auto found = names.find(name);
  if (found == names.end()) {
    user.fail("there is no " + std::string(kind) + " " + in_quotes(name) + "; expected the name of a <" + kind + ">");
  }
  return parts[static_cast<std::size_t>(found->second)];
}

}  // namespace

const MjcfBody& MjcfScene::body(const MjcfElement& user, const char* attribute) const {
  return find_part(bodies, body_names, user, attribute, "body");
}

const MjcfJoint& MjcfScene::joint(const MjcfElement& user, const char* attribute) const {
  return find_part(joints, joint_names, user, attribute, "joint");
}

const MjcfTendon& MjcfScene::tendon(const MjcfElement& user, const char* attribute) const {
  return find_part(tendons, tendon_names, user, attribute, "tendon");
}

const MjcfSite& MjcfScene::site(const MjcfElement& user, const char* attribute) const {
  const std::string name = user.text(attribute);
  const auto found = sites.find(name);
  if (found == sites.end()) user.fail("there is no site " + in_quotes(name) + "; expected the name of a <site>");
  return found->second;
}

std::size_t MjcfScene::geom(const MjcfElement& user, const char* attribute) const {
  return static_cast<std::size_t>(&find_part(geoms, geom_names, user, attribute, "geom") - geoms.data());
}

namespace {

void reserve_names(const MjcfElement& around, MjcfScene& scene) {
  for (const MjcfElement& element : around.children()) {
    const std::string name = element.text_or("name", "");
    if (!name.empty()) scene.reserved.insert(name);
    if (element.tag() == "body") scene.declared_bodies.insert(name);
    reserve_names(element, scene);
  }
}

void note_unused_sections(const MjcfElement& root) {
  static const std::set<std::string_view> kUsed{"compiler", "option", "default",  "asset",    "worldbody",
                                                "contact",  "tendon", "equality", "actuator", "keyframe"};
  static const std::set<std::string_view> kMoves{"deformable", "extension"};
  root.expect({"model"},
              {"compiler", "option", "default", "asset", "worldbody", "contact", "equality", "actuator", "keyframe",
               "size", "visual", "statistic", "custom", "extension", "sensor", "tendon", "deformable"});
  for (const MjcfElement& section : root.children()) {
    if (kUsed.contains(section.tag())) continue;
    const std::size_t count = section.children().size();
    const std::string message =
        "the section <" + std::string(section.tag()) + ">, with " + std::to_string(count) + " elements, is not used";
    if (kMoves.contains(section.tag()) && count > 0) {
      section.note_serious(LoadAction::kIgnored, message);
    } else {
      section.note(LoadAction::kIgnored, message);
    }
  }
}

Model read_scene(MjcfSource& source, const MjcfOptions& options) {
  const MjcfElement root(source, source.main(), source.main().xml.root(), "mujoco");
  if (root.tag() != "mujoco") {
    root.fail("the root element is <" + std::string(root.tag()) + ">; expected <mujoco>");
  }
  MjcfScene scene(root, options.load_meshes);
  reserve_names(root, scene);
  read_world(scene);
  read_contacts(scene);
  read_tendons(scene);
  read_equalities(scene);
  read_actuators(scene);
  read_keyframes(scene);
  apply_flags(scene);
  note_unused_sections(root);
  scene.builder.set_gravity(scene.settings.flags.gravity ? scene.settings.gravity : Vec3<double>::zero());
  scene.builder.set_time_step(scene.settings.time_step);
  for (const JointId id : scene.builder.joints_without_inertia()) {
    for (const MjcfJoint& joint : scene.joints) {
      if (joint.id != id) continue;
      scene.bodies[static_cast<std::size_t>(joint.body)].source->fail(
          "joint " + in_quotes(joint.name) +
          " moves no inertia: give the body a geom or an <inertial> with mass, or the joint an armature");
    }
  }
  return scene.builder.build();
}

}  // namespace

MjcfScene::MjcfScene(const MjcfElement& root_element, bool load_meshes)
    : root(root_element),
      settings(read_settings(root)),
      classes(read_classes(root)),
      assets(root, settings, classes, load_meshes),
      builder(root.text_or("model", "MuJoCo Model")) {}

}  // namespace io

LoadedModel load_mjcf_string(std::string_view text, const std::string& file, const fs::path& folder,
                             const MjcfOptions& options) {
  io::MjcfSource source(text, file, folder, options.allow_outside_package);
  try {
    Model model = io::read_scene(source, options);
    return {std::move(model), source.take_report()};
  } catch (const ModelError& error) {
    throw MjcfError(file, 0, error.what());
  }
}

LoadedModel load_mjcf(const fs::path& path, const MjcfOptions& options) {
  std::string text;
  try {
    text = io::read_text_file(path);
  } catch (const FileNotFound&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw MjcfError(path.string(), 0, std::string(error.what()) + "; expected an MJCF file");
  }
  return load_mjcf_string(text, path.string(), fs::absolute(path).parent_path(), options);
}

}  // namespace manyhands
