#include "manyhands/model/load_report.h"

#include <algorithm>

namespace manyhands {

const char* to_string(LoadAction action) {
  switch (action) {
    case LoadAction::kDefaulted:
      return "defaulted";
    case LoadAction::kRepaired:
      return "repaired";
    case LoadAction::kIgnored:
      return "ignored";
  }
  return "unknown";
}

std::string LoadReport::to_string() const {
  if (notes.empty()) return "nothing to report\n";
  std::string text;
  for (const LoadAction action : {LoadAction::kRepaired, LoadAction::kDefaulted, LoadAction::kIgnored}) {
    const auto is_such = [&](const LoadNote& note) { return note.action == action; };
    text += (text.empty() ? "" : ", ") + std::to_string(std::ranges::count_if(notes, is_such)) + ' ' +
            manyhands::to_string(action);
  }
  text += '\n';
  for (const LoadNote& note : notes) {
    if (!note.file.empty()) {
      text += note.file + ':';
      if (note.line > 0) text += std::to_string(note.line) + ':';
      text += ' ';
    }
    text += std::string(manyhands::to_string(note.action)) + ": " + note.element + ": " + note.message + '\n';
  }
  return text;
}

}  // namespace manyhands
