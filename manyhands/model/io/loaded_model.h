// What a loader gives back, and the error for a file that is not there.
#pragma once

#include <filesystem>
#include <stdexcept>

#include "manyhands/model/load_report.h"
#include "manyhands/model/model.h"

namespace manyhands {

struct LoadedModel {
  Model model;
  LoadReport report;
};

/// Thrown when the file that was asked for does not exist.
class FileNotFound : public std::runtime_error {
 public:
  explicit FileNotFound(const std::filesystem::path& path);
};

}  // namespace manyhands
