// Files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string_view>

namespace manyhands {

/// Writes the pieces, one after the other, to a file beside `path`, and moves it into place: whoever reads meanwhile
/// sees the old file or the new one, whole. Throws std::system_error, leaving `path` as it was.
void write_whole_file(const std::filesystem::path& path, std::initializer_list<std::span<const std::byte>> pieces);

/// The same for a text.
void write_whole_file(const std::filesystem::path& path, std::string_view text);

}  // namespace manyhands
