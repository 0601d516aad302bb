// What a loader did with a file beyond reading it: everything defaulted, repaired or ignored, with file and line.
#pragma once

#include <string>
#include <vector>

namespace manyhands {

enum class LoadAction {
  kDefaulted,  ///< the file did not say; a default was taken
  kRepaired,   ///< the file said something that cannot be simulated; it was changed
  kIgnored,    ///< the file says something that this library does not use
};

struct LoadNote {  ///< one thing that was changed or left out on loading
  LoadAction action{};
  std::string file;      ///< empty for models built in code
  int line{};            ///< 1-based; 0 if unknown
  std::string element;   ///< what it is about, for example "link 'panda_hand'"
  std::string message;   ///< what was done, with the value taken
  bool serious = false;  ///< a part is missing, or moves or touches otherwise than the file asks for
};

/// The notes of one load, in the order of the file.
struct LoadReport {
  std::vector<LoadNote> notes;

  /// How many notes of each kind, then one line a note: "file:line: repaired: link 'x': ...".
  [[nodiscard]] std::string to_string() const;
  [[nodiscard]] bool empty() const { return notes.empty(); }
};

[[nodiscard]] const char* to_string(LoadAction action);  ///< "defaulted", "repaired" or "ignored"

}  // namespace manyhands
