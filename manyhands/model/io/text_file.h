// Whole text files, bounded in size.
#pragma once

#include <filesystem>
#include <string>

namespace manyhands::io {

/// The bytes of a file. Throws FileNotFound if there is none, std::runtime_error, saying why, if it is no regular file,
/// cannot be read or has more than 128 MiB.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& path);

}  // namespace manyhands::io
