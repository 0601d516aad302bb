// The files of one MJCF model, what they include and attach, and the notes taken while they are read.
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
  std::size_t model = 0;  ///< 0, or of an <attach> what it brings
};

/// The main file with what it includes, or the same for each <attach>. In an attached model all names have its prefix.
struct MjcfModel {
  const MjcfFile* root = nullptr;
  PackagePaths paths;
  std::string main_class = "main";  ///< of its defaults
  std::string target{};             ///< the body that is attached; empty: all that lies in the world
  std::set<std::filesystem::path> included{};
  int depth = 0;             ///< how many models are around it
  bool is_repeated = false;  ///< in a <replicate>
};

class MjcfSource {
 public:
  /// Parses the text and all that it includes and attaches. Throws MjcfError.
  MjcfSource(std::string_view text, const std::string& file, const std::filesystem::path& folder, bool allow_outside,
             bool bullet);

  /// The main one, then those attached, in the order of the <attach> elements, inner ones behind those around them.
  [[nodiscard]] const std::deque<MjcfModel>& models() const { return models_; }
  /// The file that an <include> element stands for.
  [[nodiscard]] const MjcfFile& included(const pugi::xml_node& include) const;
  /// What an <attach> element stands for.
  [[nodiscard]] const MjcfModel& attached(const pugi::xml_node& attach) const;

  /// Whether Bullet's rules count.
  [[nodiscard]] bool is_bullet() const { return is_bullet_; }

  void set_main_class(std::size_t model, const std::string& name) { models_[model].main_class = name; }

  void note(LoadNote note) { report_.notes.push_back(std::move(note)); }
  /// A note about something that may occur many times: the first place is kept, the others are counted.
  void note_once(const std::string& key, LoadNote note);
  /// All notes, in the order of their lines.
  [[nodiscard]] LoadReport take_report();

 private:
  void add_model(std::string_view text, const std::string& file, PackagePaths paths, int depth);
  void add_file(std::string_view text, const std::string& name, std::size_t model);
  void read_includes(const MjcfFile& file);
  void read_attached(std::size_t model);
  void attach(const MjcfFile& file, pugi::xml_node attach, const std::string& path);

  struct Repeated {
    LoadNote note;
    int further = 0;
  };

  bool is_bullet_;
  std::deque<MjcfModel> models_;
  std::deque<MjcfFile> files_;
  std::map<std::size_t, const MjcfFile*> includes_;   ///< by the hash of the element
  std::map<std::size_t, const MjcfModel*> attached_;  ///< likewise
  std::size_t attached_bytes_ = 0;
  LoadReport report_;
  std::map<std::string, Repeated> repeated_;
};

}  // namespace manyhands::io
