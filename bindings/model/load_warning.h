// A Python warning of what a loaded file lost.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <span>
#include <string>

#include "manyhands/model/load_report.h"

namespace manyhands::bindings {

/// One LoadWarning if notes are serious: how many, the first of them, and where to read the others.
inline void warn_of(std::span<const LoadNote> notes, const std::string& report) {
  const auto first = std::ranges::find_if(notes, &LoadNote::serious);
  if (first == notes.end()) return;
  const auto count = std::ranges::count_if(notes, &LoadNote::serious);
  std::string text = first->file + ": " + first->element + ": " + first->message;
  if (count > 1) text += " (the first of " + std::to_string(count) + " parts left out or changed)";
  text += "; print " + report + " for all that was changed";
  const nanobind::object category = nanobind::module_::import_("manyhands._core").attr("LoadWarning");
  if (PyErr_WarnEx(category.ptr(), text.c_str(), 1) != 0) throw nanobind::python_error();
}

}  // namespace manyhands::bindings
