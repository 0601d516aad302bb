#include "manyhands/model/io/mjcf/mjcf.h"

#include <algorithm>
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
  static const std::set<std::string_view> kUsed{"compiler", "option",   "default",  "asset",    "worldbody", "contact",
                                                "tendon",   "equality", "actuator", "keyframe", "size",      "sensor"};
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

void note_what_bullet_leaves_out(const MjcfElement& root) {
  for (const MjcfElement& section : root.children()) {
    const std::set<std::string_view> kLeftOut{"contact", "tendon", "equality", "actuator", "keyframe"};
    if (!kLeftOut.contains(section.tag())) continue;
    section.note(LoadAction::kIgnored, "the section <" + std::string(section.tag()) + "> is not used, as in Bullet");
  }
}

constexpr double kLeastInertia = 1e-6;  // of Bullet's joints that move nothing [kg m^2 or kg]

Model read_scene(MjcfSource& source, const MjcfOptions& options) {
  const MjcfElement root(source, *source.models().front().root, source.models().front().root->xml.root(), "mujoco");
  if (root.tag() != "mujoco") {
    root.fail("the root element is <" + std::string(root.tag()) + ">; expected <mujoco>");
  }
  MjcfScene scene(root, options.load_meshes);
  scene.compliance = options.bullet ? MjcfCompliance::kNone : options.compliance;
  reserve_names(root, scene);
  read_world(scene);
  read_contacts(scene);
  if (source.is_bullet()) {
    note_what_bullet_leaves_out(root);
  } else {
    read_tendons(scene);
    read_equalities(scene);
    read_actuators(scene);
    read_sensors(scene);
    read_keyframes(scene);
  }
  apply_flags(scene);
  note_unused_sections(root);
  const MjcfFlags& flags = scene.settings.flags;
  scene.builder.set_gravity(flags.gravity ? scene.settings.gravity : Vec3<double>::zero());
  scene.builder.set_medium(flags.has_passive() ? scene.settings.medium : Medium{});
  scene.builder.set_time_step(scene.settings.time_step);
  for (const JointId id : scene.builder.joints_without_inertia()) {
    if (source.is_bullet()) {
      scene.builder.joint(id).armature = kLeastInertia;
      continue;
    }
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

namespace {

std::vector<MjcfElement> attached_roots(const MjcfElement& root) {
  std::vector<MjcfElement> roots;
  const std::deque<MjcfModel>& models = root.source().models();
  for (std::size_t i = 1; i < models.size(); ++i) {
    roots.emplace_back(root.source(), *models[i].root, models[i].root->xml.root(), "mujoco");
  }
  return roots;
}

std::vector<MjcfSettings> settings_of_all(const MjcfElement& root, const std::vector<MjcfElement>& attached) {
  std::vector<MjcfSettings> all{read_settings(root)};
  for (const MjcfElement& other : attached) all.push_back(read_settings(other));
  return all;
}

MjcfClasses classes_of_all(const MjcfElement& root, const std::vector<MjcfElement>& attached) {
  MjcfClasses classes;
  read_classes(root, classes);
  for (const MjcfElement& other : attached) read_classes(other, classes);
  return classes;
}

}  // namespace

MjcfScene::MjcfScene(const MjcfElement& root_element, bool load_meshes)
    : root(root_element),
      attached(attached_roots(root)),
      all_settings(settings_of_all(root, attached)),
      settings(all_settings.front()),
      classes(classes_of_all(root, attached)),
      assets(sections("asset"), all_settings, classes, load_meshes),
      builder(root.text_or("model", root.source().is_bullet() ? "" : "MuJoCo Model")) {}

std::vector<MjcfElement> MjcfScene::sections(std::string_view tag) const {
  std::vector<MjcfElement> found = root.children(tag);
  for (const MjcfElement& other : attached) {
    for (const MjcfElement& section : other.children(tag)) found.push_back(section);
  }
  return found;
}

std::vector<MjcfElement> MjcfScene::elements(const MjcfElement& section) const {
  const std::array<std::pair<const char*, const MjcfNames*>, 13> kinds{{{"body", &body_names},
                                                                        {"body1", &body_names},
                                                                        {"body2", &body_names},
                                                                        {"joint", &joint_names},
                                                                        {"joint1", &joint_names},
                                                                        {"joint2", &joint_names},
                                                                        {"jointinparent", &joint_names},
                                                                        {"geom", &geom_names},
                                                                        {"geom1", &geom_names},
                                                                        {"geom2", &geom_names},
                                                                        {"tendon", &tendon_names},
                                                                        {"tendon1", &tendon_names},
                                                                        {"tendon2", &tendon_names}}};
  const auto is_missing = [&](const MjcfElement& e) {
    const auto names_no = [&](const auto& kind) {
      return e.has_own(kind.first) && !kind.second->contains(e.text(kind.first));
    };
    const auto names_no_site = [&](const char* name) { return e.has_own(name) && !sites.contains(e.text(name)); };
    return std::ranges::any_of(kinds, names_no) ||
           std::ranges::any_of(std::array{"site", "site1", "site2"}, names_no_site);
  };
  const auto misses_any = [&](const MjcfElement& e) {
    return is_missing(e) || std::ranges::any_of(e.children(), is_missing);  // what a tendon passes
  };
  std::vector<MjcfElement> found;
  for (const MjcfElement& element : section.children()) {
    if (element.model() == 0 || !misses_any(element)) {
      found.push_back(element);
    } else if (root.source().models()[element.model()].is_repeated) {
      element.note_serious(LoadAction::kIgnored, "what acts on parts of a model attached in a <replicate> is left out");
    }
  }
  return found;
}

}  // namespace io

LoadedModel load_mjcf_string(std::string_view text, const std::string& file, const fs::path& folder,
                             const MjcfOptions& options) {
  io::MjcfSource source(text, file, folder, options.allow_outside_package, options.bullet);
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
