#include "manyhands/model/load_report.h"

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
  std::string text;
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
