// What a file that is written cannot say as the model does, and the names that are taken in it.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

#include "manyhands/model/io/save/save.h"

namespace manyhands::io {

class SaveNotes {
 public:
  /// `file` is what notes name; `format` what they blame.
  SaveNotes(std::string file, std::string format) : file_(std::move(file)), format_(std::move(format)) {}

  /// The same motion, said otherwise.
  void changed(std::string element, std::string message);
  /// Something that neither moves nor touches.
  void left_out(std::string element, std::string message);
  /// What moves or touches otherwise in the file.
  void loss(LoadAction action, std::string element, std::string message);
  /// Counted, not listed: "LINK: message (and N others)".
  void changed_alike(const std::string& key, std::string element, std::string message);

  /// The notes. Throws SaveError if something was lost that may not be.
  [[nodiscard]] LoadReport take(const SaveOptions& options);

 private:
  struct Alike {
    std::size_t note = 0;
    int others = 0;
  };

  void add(LoadAction action, std::string element, std::string message, bool serious);

  std::string file_, format_;
  LoadReport report_;
  std::map<std::string, Alike> alike_;
};

/// Unique names, kind by kind.
class SavedNames {
 public:
  /// `wanted`, or it with a number behind it, which is noted; of an empty one `otherwise` with a number, which is not.
  std::string claim(const std::string& kind, const std::string& wanted, const std::string& otherwise, SaveNotes& notes);
  /// `wanted`, or it with a number behind it: of parts that models have no names for.
  std::string unused(const std::string& kind, const std::string& wanted);

 private:
  std::map<std::string, std::set<std::string>> taken_;
};

/// Throws SaveError if an XML attribute cannot hold the text.
void require_text(std::string_view text);

/// "link 'hand'".
[[nodiscard]] std::string part(const char* kind, std::string_view name);

}  // namespace manyhands::io
