#include "manyhands/model/io/image/png.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>

namespace manyhands::io {

namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char c : bytes.substr(0, 4)) value = value << 8 | static_cast<std::uint8_t>(c);
  return value;
}

struct Header {
  std::size_t width = 0, height = 0;
  std::size_t depth = 0;  ///< bits of a sample
  int kind = 0;           ///< 0 grey, 2 colours, 3 palette, 4 grey and alpha, 6 colours and alpha
  bool interlaced = false;

  [[nodiscard]] std::size_t bits_per_pixel() const {
    constexpr std::array<std::size_t, 7> kSamples{1, 0, 3, 1, 2, 0, 4};
    return depth * kSamples[static_cast<std::size_t>(kind)];
  }
};

/// The pictures of which an interlaced one consists; a plain one is a single pass.
struct Pass {
  std::size_t x, y, dx, dy;
  [[nodiscard]] std::size_t columns(const Header& h) const { return h.width > x ? (h.width - x + dx - 1) / dx : 0; }
  [[nodiscard]] std::size_t rows(const Header& h) const { return h.height > y ? (h.height - y + dy - 1) / dy : 0; }
  [[nodiscard]] std::size_t bytes_per_row(const Header& h) const { return (columns(h) * h.bits_per_pixel() + 7) / 8; }
};

std::vector<Pass> passes_of(const Header& header) {
  if (!header.interlaced) return {{0, 0, 1, 1}};
  return {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
}

Header read_header(std::string_view chunk, std::size_t most_pixels) {
  if (chunk.size() != 13) throw ImageError("its header has the wrong size");
  const auto byte = [&](std::size_t i) { return static_cast<int>(static_cast<std::uint8_t>(chunk[i])); };
  Header header{.width = big_endian(chunk),
                .height = big_endian(chunk.substr(4)),
                .depth = static_cast<std::size_t>(byte(8)),
                .kind = byte(9),
                .interlaced = byte(12) == 1};
  if (header.width == 0 || header.height == 0 || header.width > most_pixels / header.height) {
    throw ImageError("it has " + std::to_string(header.width) + " x " + std::to_string(header.height) +
                     " pixels; expected 1 to " + std::to_string(most_pixels));
  }
  const std::size_t d = header.depth;
  const bool small = d == 1 || d == 2 || d == 4, whole = d == 8 || d == 16;
  const bool known = header.kind == 0   ? small || whole
                     : header.kind == 3 ? small || d == 8
                                        : whole && (header.kind == 2 || header.kind == 4 || header.kind == 6);
  if (!known || byte(10) != 0 || byte(11) != 0 || byte(12) > 1) throw ImageError("its header asks for what is no PNG");
  return header;
}

std::uint8_t paeth(int left, int above, int corner) {
  const int p = left + above - corner;
  const int a = std::abs(p - left), b = std::abs(p - above), c = std::abs(p - corner);
  return static_cast<std::uint8_t>(a <= b && a <= c ? left : b <= c ? above : corner);
}

/// Undoes the filter of a row, in place; `before` is the row above, or zeros.
void unfilter(int filter, std::size_t step, std::span<const std::uint8_t> before, std::span<std::uint8_t> row) {
  if (filter > 4) throw ImageError("a row has an unknown filter");
  for (std::size_t i = 0; i < row.size(); ++i) {
    const int left = i < step ? 0 : row[i - step], above = before[i], corner = i < step ? 0 : before[i - step];
    const int guess = filter == 1   ? left
                      : filter == 2 ? above
                      : filter == 3 ? (left + above) / 2
                      : filter == 4 ? paeth(left, above, corner)
                                    : 0;
    row[i] = static_cast<std::uint8_t>(row[i] + guess);
  }
}

class Reader {
 public:
  Reader(const Header& header, std::string_view palette) : header_(header), palette_(palette) {}

  GreyImage read(std::string_view compressed) {
    std::size_t size = 0;
    for (const Pass& pass : passes_of(header_)) {
      if (pass.columns(header_) > 0) size += pass.rows(header_) * (1 + pass.bytes_per_row(header_));
    }
    std::vector<std::uint8_t> bytes = inflated(compressed, size);
    image_ = {.width = header_.width, .height = header_.height, .values = {}};
    image_.values.resize(header_.width * header_.height);
    std::span<std::uint8_t> rest(bytes);
    for (const Pass& pass : passes_of(header_)) {
      if (pass.columns(header_) > 0) rest = read_pass(pass, rest);
    }
    return std::move(image_);
  }

 private:
  std::span<std::uint8_t> read_pass(const Pass& pass, std::span<std::uint8_t> rest) {
    const std::size_t length = pass.bytes_per_row(header_),
                      step = std::max<std::size_t>(header_.bits_per_pixel() / 8, 1);
    const std::vector<std::uint8_t> zeros(length, 0);
    std::span<const std::uint8_t> before(zeros);
    for (std::size_t j = 0; j < pass.rows(header_); ++j) {
      const std::span<std::uint8_t> row = rest.subspan(1, length);
      unfilter(rest[0], step, before, row);
      for (std::size_t i = 0; i < pass.columns(header_); ++i) {
        image_.values[(pass.y + j * pass.dy) * image_.width + pass.x + i * pass.dx] = value(row, i);
      }
      before = row;
      rest = rest.subspan(1 + length);
    }
    return rest;
  }

  /// The first sample of a pixel, as 8 bits.
  [[nodiscard]] std::uint8_t value(std::span<const std::uint8_t> row, std::size_t pixel) const {
    const std::size_t bit = pixel * header_.bits_per_pixel();
    if (header_.depth >= 8 && header_.kind != 3) return row[bit / 8];
    const unsigned most = (1u << header_.depth) - 1;
    const unsigned sample = (row[bit / 8] >> (8 - header_.depth - bit % 8)) & most;
    if (header_.kind != 3) return static_cast<std::uint8_t>(sample * 255 / most);
    const std::size_t red = std::size_t{3} * sample;
    if (red >= palette_.size()) throw ImageError("a pixel has a colour that is not in the palette");
    return static_cast<std::uint8_t>(palette_[red]);
  }

  const Header& header_;
  std::string_view palette_;
  GreyImage image_;
};

}  // namespace

GreyImage read_png(std::string_view bytes, std::size_t most_pixels) {
  if (!bytes.starts_with(kSignature)) throw ImageError("it does not begin as a PNG does");
  bytes.remove_prefix(kSignature.size());
  std::optional<Header> header;
  std::string_view palette;
  std::string compressed;
  while (true) {
    constexpr std::size_t kAround = 12;  // length, kind and check sum of a chunk
    if (bytes.size() < kAround || bytes.size() - kAround < big_endian(bytes)) throw ImageError("it ends too early");
    const std::string_view kind = bytes.substr(4, 4), chunk = bytes.substr(8, big_endian(bytes));
    bytes.remove_prefix(kAround + chunk.size());
    if (kind == "IEND") break;
    if (kind == "IHDR") header = read_header(chunk, most_pixels);
    if (kind == "PLTE") palette = chunk;
    if (kind == "IDAT") compressed += chunk;
  }
  if (!header) throw ImageError("it has no header");
  return Reader(*header, palette).read(compressed);
}

}  // namespace manyhands::io
