#include "manyhands/model/io/mjcf/mjcf_source.h"

#include <algorithm>

#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/model/io/text_file.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace fs = std::filesystem;

namespace {

XmlFile parse_xml(std::string_view text, const std::string& file) {
  try {
    return XmlFile(text);
  } catch (const XmlError& error) {
    throw MjcfError(file, error.line(), error.what());
  }
}

}  // namespace

MjcfSource::MjcfSource(std::string_view text, const std::string& file, const fs::path& folder, bool allow_outside)
    : paths_(folder, {}, allow_outside) {
  add_file(text, file);
  // NOLINTNEXTLINE(modernize-loop-convert): files_ grows meanwhile
  for (std::size_t i = 0; i < files_.size(); ++i) read_includes(files_[i]);
}

void MjcfSource::add_file(std::string_view text, const std::string& name) {
  files_.push_back({name, parse_xml(text, name)});
}

void MjcfSource::read_includes(const MjcfFile& file) {
  struct Finder : pugi::xml_tree_walker {
    bool for_each(pugi::xml_node& node) override {
      if (std::string_view(node.name()) == "include") found.push_back(node);
      return true;
    }
    std::vector<pugi::xml_node> found;
  } finder;
  pugi::xml_node root = file.xml.root();
  root.traverse(finder);
  for (const pugi::xml_node& include : finder.found) {
    const std::string name = include.attribute("file").value();
    const auto fail = [&](const std::string& what) {
      throw MjcfError(file.name, file.xml.line(include), "<include> of " + in_quotes(name) + ": " + what);
    };
    if (name.empty()) fail("attribute 'file' is missing");
    try {
      const fs::path path = paths_.resolve(name);
      if (!included_paths_.insert(path).second) fail("the file is included already; expected it once");
      add_file(read_text_file(path), path.string());
    } catch (const MjcfError&) {
      throw;
    } catch (const std::runtime_error& error) {
      fail(error.what());
    }
    includes_.emplace(include.hash_value(), &files_.back());
  }
}

const MjcfFile& MjcfSource::included(const pugi::xml_node& include) const {
  return *includes_.at(include.hash_value());
}

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
