// <sdf>, <world>, <model> and <include>: which models there are, and where.
#include <algorithm>

#include "manyhands/model/io/sdf/sdf_parts.h"
#include "manyhands/model/io/text_file.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace fs = std::filesystem;

namespace {

constexpr int kMostDepth = 16;
constexpr std::size_t kMostFiles = 1000;
constexpr std::size_t kMostBytes = std::size_t{256} << 20;

XmlFile parse_xml(std::string_view text, const std::string& name) {
  try {
    return XmlFile(text);
  } catch (const XmlError& error) {
    throw SdfError(name, error.line(), error.what());
  }
}

/// "1.6" as 106, "1.10" as 110; the newest version where it is not given.
int version_of(const std::string& text) {
  constexpr int kNewest = 112;
  const std::size_t dot = text.find('.');
  const std::optional<double> minor = dot == text.npos ? std::nullopt : parse_number(text.substr(dot + 1));
  if (!minor || !(*minor >= 0 && *minor < 100)) return kNewest;
  return 100 + static_cast<int>(*minor);
}

/// What an <include> says of the model that it brings.
struct Included {
  std::string name{};
  std::optional<SdfPose> pose{};
  std::string placement{};
  bool is_static = false;
};

class SdfReader {
 public:
  SdfReader(SdfWorld& world, const SdfOptions& options) : world_(world), options_(options) {}

  void read(std::string_view text, const std::string& name, const fs::path& folder) {
    const SdfElement root = add_file(
        text, name, PackagePaths(folder, options_.package_paths, options_.allow_outside_package, options_.bullet));
    if (root.tag() != "sdf") {
      root.fail("the root element is <" + std::string(root.tag()) + ">; expected <sdf version=\"1.6\">");
    }
    root.expect({"world", "model"});
    for (const SdfElement& element : root.children()) {
      if (element.tag() == "world") read_world(element.named("world"));
      if (element.tag() == "model") read_top_model(element, {});
    }
    if (world_.models.empty()) root.fail("there is no model in it; expected <world> or <model>");
  }

 private:
  SdfElement add_file(std::string_view text, const std::string& name, PackagePaths paths) {
    XmlFile xml = parse_xml(text, name);
    const pugi::xml_node root = xml.root();
    const int version = version_of(root.attribute("version").value());
    world_.files.push_back({name, std::move(xml), std::move(paths), version, &world_.notes});
    return {world_.files.back(), root, std::string(root.name())};
  }

  void read_world(const SdfElement& world) {
    world.expect({"gravity", "physics", "model", "include", "frame"});
    if (world.has("gravity")) world_.gravity = world.vec3_or("gravity", {});
    if (const SdfElement physics = world.child("physics")) {
      physics.expect({"max_step_size", "gravity", "real_time_factor", "real_time_update_rate"});
      if (physics.has("gravity")) world_.gravity = physics.vec3_or("gravity", {});
      if (physics.has("max_step_size")) world_.time_step = physics.number_or("max_step_size", 0);
      if (world_.time_step && !(*world_.time_step > 0)) physics.fail("max_step_size is not above 0");
    }
    for (const SdfElement& element : world.children()) {
      if (element.tag() == "frame") read_frame(element, "", "");
      if (element.tag() == "model") read_top_model(element, {});
      if (element.tag() == "include") include(element, nullptr, "", 0);
    }
  }

  /// A model of the world, with notes of its own.
  void read_top_model(const SdfElement& element, const Included& included) {
    world_.models.push_back({.source = element, .name = {}, .key = {}});
    SdfModel& model = world_.models.back();
    world_.notes = &model.report;
    const std::string given = included.name.empty() ? element.name() : included.name;
    model.name = given;
    const auto is_taken = [&](const SdfModel& other) { return &other != &model && other.name == model.name; };
    while (std::ranges::any_of(world_.models, is_taken)) model.name += '_';
    if (model.name != given) {
      element.note(LoadAction::kRepaired,
                   "there is another model " + in_quotes(given) + "; this one is called " + in_quotes(model.name));
    }
    model.source = element.named("model '" + model.name + "'");
    model.key = model.name + "::__model__";
    read_model(model.source, model, model.name, "", included, 0);
    world_.notes = &world_.report;
  }

  /// The contents of a <model> of that name, in `scope`, as parts of `top`.
  void read_model(const SdfElement& element, SdfModel& top, const std::string& name, const std::string& scope,
                  const Included& included, int depth) {
    if (depth > kMostDepth) element.fail("models are nested more than 16 deep; does it include itself?");
    element.expect({"pose", "static", "self_collide", "link", "joint", "frame", "model", "include"});
    const std::string inner = scope + name + "::", key = inner + "__model__";
    SdfFrame frame{.source = element, .scope = scope, .pose = included.pose.value_or(element.pose())};
    frame.base = depth == 0 ? "" : scope + "__model__";
    frame.placement = included.placement.empty() ? element.attribute("placement_frame") : included.placement;
    frame.attached_scope = inner;
    frame.attached_to = element.attribute("canonical_link");
    world_.frames.add(key, std::move(frame));
    if (included.is_static || element.flag_or("static", false)) top.is_static = true;
    if (element.flag_or("self_collide", false)) top.self_collide = true;

    std::string first;  // what the model's frame moves with
    for (const SdfElement& part : element.children()) {
      const std::string_view tag = part.tag();
      if (tag == "link") {
        add_link(part, top, inner);
        if (first.empty()) first = part.name();
      } else if (tag == "joint") {
        add_joint(part, top, inner);
      } else if (tag == "frame") {
        read_frame(part, inner, inner + "__model__");
      } else if (tag == "model") {
        read_model(part.named("model '" + inner + part.name() + "'"), top, part.name(), inner, {}, depth + 1);
        if (first.empty()) first = part.name();
      } else if (tag == "include") {
        const std::string brought = include(part, &top, inner, depth);
        if (first.empty()) first = brought;
      }
    }
    SdfFrame& own = world_.frames.at(key);
    if (first.empty()) element.fail("it has no <link>; expected at least one");
    if (own.attached_to.empty()) own.attached_to = first;
  }

  /// The name of a part in its model: without the model's own.
  static std::string name_in(const SdfModel& top, const std::string& key) { return key.substr(top.name.size() + 2); }

  void add_link(const SdfElement& element, SdfModel& top, const std::string& scope) {
    const std::string key = scope + element.name();
    const SdfElement source = element.named("link '" + name_in(top, key) + "'");
    SdfLink link = read_link(source, options_, masks_within(element));
    link.name = name_in(top, key);
    link.scope = scope;
    link.key = key;
    if (source.flag_or("self_collide", false)) top.self_collide = true;
    world_.frames.add(key, {.source = source, .scope = scope, .pose = source.pose(), .base = scope + "__model__"});
    top.links.push_back(std::move(link));
  }

  void add_joint(const SdfElement& element, SdfModel& top, const std::string& scope) {
    const std::string key = scope + element.name();
    const SdfElement source = element.named("joint '" + name_in(top, key) + "'");
    SdfJoint joint = read_joint(source);
    joint.name = name_in(top, key);
    joint.scope = scope;
    joint.key = key;
    SdfFrame frame{.source = source, .scope = scope};
    if (!options_.bullet) frame.pose = source.pose();
    if (frame.pose.relative_to.empty()) frame.pose.relative_to = joint.child;
    frame.attached_to = joint.child;
    frame.attached_scope = scope;
    world_.frames.add(key, std::move(frame));
    top.joints.push_back(std::move(joint));
  }

  void read_frame(const SdfElement& element, const std::string& scope, const std::string& model) {
    const SdfElement source = element.named("frame '" + scope + element.name() + "'");
    source.expect({"pose"});
    SdfFrame frame{.source = source, .scope = scope, .pose = source.pose(), .base = model, .attached_scope = scope};
    frame.attached_to = source.attribute("attached_to");
    if (frame.pose.relative_to.empty()) frame.pose.relative_to = frame.attached_to;
    if (frame.attached_to.empty()) frame.attached_to = scope.empty() ? "world" : "__model__";
    world_.frames.add(scope + element.name(), std::move(frame));
  }

  bool masks_within(const SdfElement& element) {
    const SdfFile* const file = &element.file();
    const auto [entry, is_new] = has_masks_.try_emplace(file, false);
    if (is_new) entry->second = SdfElement(*file, file->xml.root(), "").has_within("collide_bitmask");
    return entry->second;
  }

  /// Reads an included model: into the world, or as a part of `top`. Returns its name; empty if it is left out.
  std::string include(const SdfElement& include, SdfModel* top, const std::string& scope, int depth) {
    include.expect({"uri", "name", "pose", "static", "placement_frame"});
    const std::string uri = include.text_or("uri", "");
    const SdfElement element = include.named("include of " + in_quotes(uri));
    if (depth >= kMostDepth) element.fail("models are nested more than 16 deep; does it include itself?");
    if (world_.files.size() >= kMostFiles || bytes_ > kMostBytes) {
      element.fail("more is included than 1000 files or 256 MiB");
    }
    const std::optional<SdfElement> model = model_of(element, uri);
    if (!model) return "";
    Included included{.name = include.text_or("name", ""), .placement = include.text_or("placement_frame", "")};
    if (include.has("pose")) included.pose = include.pose();
    included.is_static = include.flag_or("static", false);
    const std::string name = included.name.empty() ? model->name() : included.name;
    if (include.attribute("merge") == "true" || include.attribute("merge") == "1") {
      element.note_serious(LoadAction::kRepaired, "it is not merged: its parts are called \"" + name + "::...\"");
    }
    if (top == nullptr) {
      read_top_model(*model, included);
    } else {
      read_model(model->named("model '" + scope + name + "'"), *top, name, scope, included, depth + 1);
    }
    return name;
  }

  /// The <model> in the file that the name leads to; nothing, which is noted, if there is none.
  std::optional<SdfElement> model_of(const SdfElement& include, const std::string& uri) {
    const auto left_out = [&](const std::string& why) {
      include.note_serious(LoadAction::kIgnored, why + "; the model is left out");
      return std::nullopt;
    };
    try {
      const fs::path path = file_of(include.file().paths, uri);
      const std::string text = read_text_file(path);
      bytes_ += text.size();
      const bool has_scheme = uri.find("://") != uri.npos;
      PackagePaths paths = has_scheme ? PackagePaths(path.parent_path(), options_.package_paths,
                                                     options_.allow_outside_package, options_.bullet)
                                      : include.file().paths.at(path.parent_path());
      const SdfElement root = add_file(text, path.string(), std::move(paths));
      const SdfElement model = root.tag() == "sdf" ? root.child("model") : root.child("sdf");
      if (root.tag() != "sdf" || !model) return left_out("there is no <model> in " + in_quotes(path.string()));
      return model;
    } catch (const PathEscape& error) {
      include.fail(error.what());
    } catch (const SdfError&) {
      throw;
    } catch (const std::runtime_error& error) {
      return left_out(error.what());
    }
  }

  /// The file itself, or the newest one that the manifest in a model's folder names.
  static fs::path file_of(const PackagePaths& paths, const std::string& uri) {
    if (uri.ends_with(".sdf") || uri.ends_with(".world")) return paths.resolve(uri);
    std::string newest = "model.sdf";
    int version = 0;
    fs::path manifest;
    try {
      manifest = paths.resolve(uri + "/model.config");
    } catch (const PathEscape&) {
      throw;
    } catch (const std::runtime_error&) {
      return paths.resolve(uri + "/" + newest);
    }
    const XmlFile xml = parse_xml(read_text_file(manifest), manifest.string());
    for (const pugi::xml_node& node : xml.root().children("sdf")) {
      const int other = version_of(node.attribute("version").value());
      const std::vector<std::string_view> name = split_blanks(node.child_value());
      if (name.size() != 1 || other < version) continue;
      version = other;
      newest = name[0];
    }
    return paths.resolve(uri + "/" + newest);
  }

  SdfWorld& world_;
  const SdfOptions& options_;
  std::map<const SdfFile*, bool> has_masks_;
  std::size_t bytes_ = 0;  ///< of files that are included
};

}  // namespace

void read_sdf(SdfWorld& world, std::string_view text, const std::string& name, const fs::path& folder,
              const SdfOptions& options) {
  SdfReader(world, options).read(text, name, folder);
}

}  // namespace manyhands::io
