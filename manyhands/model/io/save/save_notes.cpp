#include "manyhands/model/io/save/save_notes.h"

#include <algorithm>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

void SaveNotes::add(LoadAction action, std::string element, std::string message, bool serious) {
  report_.notes.push_back({.action = action,
                           .file = file_,
                           .element = std::move(element),
                           .message = std::move(message),
                           .serious = serious});
}

void SaveNotes::changed(std::string element, std::string message) {
  add(LoadAction::kRepaired, std::move(element), std::move(message), false);
}

void SaveNotes::left_out(std::string element, std::string message) {
  add(LoadAction::kIgnored, std::move(element), std::move(message), false);
}

void SaveNotes::loss(LoadAction action, std::string element, std::string message) {
  add(action, std::move(element), std::move(message), true);
}

void SaveNotes::changed_alike(const std::string& key, std::string element, std::string message) {
  const auto [entry, is_new] = alike_.try_emplace(key, Alike{report_.notes.size(), 0});
  if (is_new) {
    changed(std::move(element), std::move(message));
  } else {
    ++entry->second.others;
  }
}

LoadReport SaveNotes::take(const SaveOptions& options) {
  for (const auto& [key, alike] : alike_) {
    if (alike.others > 0) report_.notes[alike.note].message += "; " + std::to_string(alike.others) + " others likewise";
  }
  const auto count = std::ranges::count_if(report_.notes, &LoadNote::serious);
  if (count > 0 && !options.allow_loss) {
    const LoadNote& first = *std::ranges::find_if(report_.notes, &LoadNote::serious);
    std::string text = first.element + ": " + first.message;
    if (count > 1) text += " (the first of " + std::to_string(count) + " such parts)";
    throw SaveError(text + "; " + format_ + " cannot say it, and nothing was written; allow_loss writes the rest");
  }
  return std::move(report_);
}

std::string SavedNames::claim(const std::string& kind, const std::string& wanted, const std::string& otherwise,
                              SaveNotes& notes) {
  std::set<std::string>& taken = taken_[kind];
  std::string name = wanted;
  for (int number = wanted.empty() ? 0 : 2; name.empty() || taken.contains(name); ++number) {
    name = (wanted.empty() ? otherwise : wanted) + "_" + std::to_string(number);
  }
  require_text(name);
  if (!wanted.empty() && name != wanted)
    notes.changed(part(kind.c_str(), wanted), "the name is taken; called '" + name + "'");
  taken.insert(name);
  return name;
}

std::string SavedNames::unused(const std::string& kind, const std::string& wanted) {
  std::string name = wanted;
  for (int number = 2; !taken_[kind].insert(name).second; ++number) name = wanted + "_" + std::to_string(number);
  return name;
}

void require_text(std::string_view text) {
  const auto is_unfit = [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r';
  };
  if (std::ranges::any_of(text, is_unfit)) {
    throw SaveError("the name " + in_quotes(text) +
                    " holds a control character, which XML cannot say; rename the part");
  }
}

std::string part(const char* kind, std::string_view name) { return std::string(kind) + " " + in_quotes(name); }

}  // namespace manyhands::io
