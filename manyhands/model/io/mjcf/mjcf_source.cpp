#include "manyhands/model/io/mjcf/mjcf_source.h"

#include <algorithm>

#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/model/io/mjcf/mjcf_attach.h"
#include "manyhands/model/io/text_file.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace fs = std::filesystem;

namespace {

constexpr int kMostDepth = 16;                  // of models in models
constexpr std::size_t kMostModels = 1000;       // attached, in all
constexpr std::size_t kMostBytes = 256u << 20;  // of their texts

XmlFile parse_xml(std::string_view text, const std::string& file) {
  try {
    return XmlFile(text);
  } catch (const XmlError& error) {
    throw MjcfError(file, error.line(), error.what());
  }
}

std::vector<pugi::xml_node> find_all(const MjcfFile& file, std::string_view tag) {
  struct Finder : pugi::xml_tree_walker {
    bool for_each(pugi::xml_node& node) override {
      if (std::string_view(node.name()) == tag) found.push_back(node);
      return true;
    }
    std::string_view tag;
    std::vector<pugi::xml_node> found;
  } finder;
  finder.tag = tag;
  pugi::xml_node root = file.xml.root();
  root.traverse(finder);
  return finder.found;
}

[[noreturn]] void fail_at(const MjcfFile& file, const pugi::xml_node& node, const std::string& what) {
  throw MjcfError(file.name, file.xml.line(node), "<" + std::string(node.name()) + "> " + what);
}

}  // namespace

MjcfSource::MjcfSource(std::string_view text, const std::string& file, const fs::path& folder, bool allow_outside,
                       bool bullet)
    : is_bullet_(bullet) {
  add_model(text, file, PackagePaths(folder, {}, allow_outside), 0);
}

void MjcfSource::add_model(std::string_view text, const std::string& file, PackagePaths paths, int depth) {
  const std::size_t model = models_.size(), first = files_.size();
  models_.push_back({.paths = std::move(paths), .depth = depth});
  add_file(text, file, model);
  models_[model].root = &files_[first];
  for (std::size_t i = first; i < files_.size(); ++i) read_includes(files_[i]);
  read_attached(model);
}

void MjcfSource::add_file(std::string_view text, const std::string& name, std::size_t model) {
  files_.push_back({name, parse_xml(text, name), model});
}

void MjcfSource::read_includes(const MjcfFile& file) {
  MjcfModel& model = models_[file.model];
  for (const pugi::xml_node& include : find_all(file, "include")) {
    const std::string name = include.attribute("file").value();
    const auto fail = [&](const std::string& what) { fail_at(file, include, "of " + in_quotes(name) + ": " + what); };
    if (name.empty()) fail("attribute 'file' is missing");
    try {
      const fs::path path = model.paths.resolve(name);
      if (!model.included.insert(path).second) fail("the file is included already; expected it once");
      add_file(read_text_file(path), path.string(), file.model);
    } catch (const MjcfError&) {
      throw;
    } catch (const std::runtime_error& error) {
      fail(error.what());
    }
    includes_.emplace(include.hash_value(), &files_.back());
  }
}

void MjcfSource::read_attached(std::size_t model) {
  std::map<std::string, std::string> paths;  // of the models among the assets
  for (const MjcfFile& file : files_) {
    if (file.model != model) continue;
    for (const pugi::xml_node& asset : find_all(file, "model")) {
      const std::string path = asset.attribute("file").value(), name = asset.attribute("name").value();
      if (path.empty()) fail_at(file, asset, in_quotes(name) + ": attribute 'file' is missing");
      paths.emplace(name.empty() ? fs::path(path).stem().string() : name, path);
    }
  }
  const std::size_t end = files_.size();
  for (std::size_t i = 0; i < end; ++i) {
    if (files_[i].model != model) continue;
    for (const pugi::xml_node& node : find_all(files_[i], "attach")) {
      const std::string name = node.attribute("model").value();
      const auto path = paths.find(name);
      if (path == paths.end()) {
        fail_at(files_[i], node, "of " + in_quotes(name) + ": expected the name of a <model> in <asset>");
      }
      attach(files_[i], node, path->second);
    }
  }
}

void MjcfSource::attach(const MjcfFile& file, pugi::xml_node attach, const std::string& path) {
  const auto fail = [&](const std::string& what) { fail_at(file, attach, "of " + in_quotes(path) + ": " + what); };
  const MjcfModel& around = models_[file.model];
  if (around.depth >= kMostDepth) fail("models are nested more than 16 deep; does it attach itself?");
  if (models_.size() > kMostModels || attached_bytes_ > kMostBytes)
    fail("more is attached than 1000 models or 256 MiB");
  const std::size_t first = models_.size();
  try {
    const fs::path found = around.paths.resolve(path);
    const std::string text = read_text_file(found);
    attached_bytes_ += text.size();
    add_model(text, found.string(), around.paths.at(found.parent_path()), around.depth + 1);
  } catch (const MjcfError&) {
    throw;
  } catch (const std::runtime_error& error) {
    fail(error.what());
  }
  models_[first].target = attach.attribute("body").value();
  for (pugi::xml_node above = attach.parent(); above; above = above.parent()) {
    models_[first].is_repeated |= std::string_view(above.name()) == "replicate";
  }
  attached_.emplace(attach.hash_value(), &models_[first]);
  const std::string prefix = attach.attribute("prefix").value();
  for (const MjcfFile& inner : files_) {
    if (inner.model >= first) add_prefix(prefix, inner.xml.root());
  }
  for (std::size_t i = first; i < models_.size(); ++i) {
    models_[i].main_class = prefix + models_[i].main_class;
    if (!models_[i].target.empty()) models_[i].target = prefix + models_[i].target;
  }
}

const MjcfFile& MjcfSource::included(const pugi::xml_node& include) const {
  return *includes_.at(include.hash_value());
}

const MjcfModel& MjcfSource::attached(const pugi::xml_node& attach) const { return *attached_.at(attach.hash_value()); }

void MjcfSource::note_once(const std::string& key, LoadNote note) {
  const auto [entry, is_new] = repeated_.try_emplace(key, Repeated{std::move(note)});
  if (!is_new) ++entry->second.further;
}

LoadReport MjcfSource::take_report() {
  for (auto& [key, repeated] : repeated_) {
    if (repeated.further > 0) {
      repeated.note.message += " (and in " + std::to_string(repeated.further) + " further places)";
    }
    report_.notes.push_back(std::move(repeated.note));
  }
  repeated_.clear();
  std::ranges::stable_sort(report_.notes, {}, &LoadNote::line);
  return std::move(report_);
}

}  // namespace manyhands::io
