// Policies from the ONNX files that training writes (python/manyhands/training/policy_file.py).
#pragma once

#include <filesystem>

#include "manyhands/learn/policy.h"

namespace manyhands::learn {

/// The policy in a file. Weights of 16 bits become 32. Throws std::invalid_argument, with the path and the reason, if
/// there is no such file or it holds another graph.
[[nodiscard]] Policy read_policy(const std::filesystem::path& path);

}  // namespace manyhands::learn
