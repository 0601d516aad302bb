#include "manyhands/learn/archive.h"

#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <system_error>

#include "manyhands/base/whole_file.h"

namespace manyhands::learn {

namespace {

constexpr std::array<char, 8> kMagic = {'m', 'h', 'l', 'e', 'a', 'r', 'n', '\n'};
constexpr std::uint32_t kVersion = 2;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t byte_order = 0x01020304;
  std::uint64_t payload_bytes{};
  std::uint64_t checksum{};
};
static_assert(std::is_trivially_copyable_v<Header> && sizeof(Header) == 32);

/// FNV-1a over words instead of bytes, with a rotation so that high bits spread too.
std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < bytes.size(); i += sizeof sum) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min(sizeof word, bytes.size() - i));
    sum = std::rotl((sum ^ word) * 0x100000001b3u, 29);
  }
  return sum;
}

}  // namespace

void ArchiveWriter::append(const void* data, std::size_t bytes) {
  const auto* from = static_cast<const std::byte*>(data);
  bytes_.insert(bytes_.end(), from, from + bytes);
}

void ArchiveWriter::commit(const std::filesystem::path& path) const {
  Header header;
  header.payload_bytes = bytes_.size();
  header.checksum = checksum(bytes_);
  try {
    write_whole_file(path, {std::as_bytes(std::span(&header, 1)), bytes_});
  } catch (const std::system_error& error) {
    throw CheckpointError("cannot write checkpoint " + path.string() + ": " + error.code().message());
  }
}

ArchiveReader::ArchiveReader(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  check(regular && !error, "there is no such file");
  const std::uintmax_t file_bytes = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  Header header;
  check(!error && file_bytes >= sizeof header && file.read(reinterpret_cast<char*>(&header), sizeof header),
        "it is not a checkpoint of this program (too short)");
  check(header.magic == kMagic, "it is not a checkpoint of this program");
  check(header.version == kVersion,
        "it has format version " + std::to_string(header.version) + ", this program reads " + std::to_string(kVersion));
  check(header.byte_order == Header{}.byte_order, "it was written on a machine of another byte order");
  check(header.payload_bytes == file_bytes - sizeof header,
        "it is cut off or has bytes too many (" + std::to_string(file_bytes) + " bytes, " +
            std::to_string(header.payload_bytes + sizeof header) + " expected)");
  bytes_.resize(static_cast<std::size_t>(header.payload_bytes));
  file.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
  check(static_cast<bool>(file) && checksum(bytes_) == header.checksum, "its contents are damaged (wrong checksum)");
}

void ArchiveReader::extract(void* data, std::size_t bytes) {
  check(bytes <= bytes_.size() - at_, "it ends too early");
  if (bytes == 0) return;  // `data` may be null
  std::memcpy(data, bytes_.data() + at_, bytes);
  at_ += bytes;
}

std::string ArchiveReader::text() {
  const auto length = value<std::uint64_t>();
  check(length <= bytes_.size() - at_, "it ends too early");
  std::string text(static_cast<std::size_t>(length), '\0');
  extract(text.data(), text.size());
  return text;
}

void ArchiveReader::check(bool holds, const std::string& complaint) const {
  if (!holds) throw CheckpointError("cannot load checkpoint " + path_.string() + ": " + complaint);
}

void ArchiveReader::finish() const { check(at_ == bytes_.size(), "it holds more than this trainer's state"); }

void ArchiveReader::mismatch(const std::string& what, const std::string& stored, const std::string& own) const {
  throw CheckpointError("cannot load checkpoint " + path_.string() + ": its " + what + " is " + stored +
                        ", this trainer's is " + own);
}

}  // namespace manyhands::learn
