// The files of one MJCF model, what they include, and the notes taken while they are read.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "manyhands/model/io/package_paths.h"
#include "manyhands/model/io/xml_file.h"
#include "manyhands/model/load_report.h"

namespace manyhands::io {

/// One XML text and its name in messages.
struct MjcfFile {
  std::string name;
  XmlFile xml;
};

class MjcfSource {
 public:
  /// Parses the text and all that it includes. Throws MjcfError.
  MjcfSource(std::string_view text, const std::string& file, const std::filesystem::path& folder, bool allow_outside);

  [[nodiscard]] const MjcfFile& main() const { return files_.front(); }
  /// The file that an <include> element stands for.
  [[nodiscard]] const MjcfFile& included(const pugi::xml_node& include) const;
  [[nodiscard]] const PackagePaths& paths() const { return paths_; }

  void note(LoadNote note) { report_.notes.push_back(std::move(note)); }
  /// A note about something that may occur many times: the first place is kept, the others are counted.
  void note_once(const std::string& key, LoadNote note);
  /// All notes, in the order of their lines.
  [[nodiscard]] LoadReport take_report();

 private:
  void add_file(std::string_view text, const std::string& name);
  void read_includes(const MjcfFile& file);

  struct Repeated {
    LoadNote note;
    int further = 0;
  };

  PackagePaths paths_;
  std::deque<MjcfFile> files_;
  std::map<std::size_t, const MjcfFile*> includes_;  ///< by the hash of the element
  std::set<std::filesystem::path> included_paths_;
  LoadReport report_;
  std::map<std::string, Repeated> repeated_;
};

}  // namespace manyhands::io
