#include "manyhands/model/io/text_file.h"

#include <fstream>

#include "manyhands/model/io/loaded_model.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands {

namespace fs = std::filesystem;

FileNotFound::FileNotFound(const fs::path& path)
    : std::runtime_error("there is no file " + io::in_quotes(path.string())) {}

std::string io::read_text_file(const fs::path& path) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{128} << 20;
  std::error_code error;
  if (!fs::exists(path, error)) throw FileNotFound(path);
  if (!fs::is_regular_file(path, error)) throw std::runtime_error("not a file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size > kMostBytes) throw std::runtime_error("larger than 128 MiB");
  std::string text(static_cast<std::size_t>(size), '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(size));
  if (!stream) throw std::runtime_error("the file cannot be read; check its permissions");
  return text;
}

}  // namespace manyhands
