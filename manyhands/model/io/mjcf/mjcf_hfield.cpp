// <hfield>: heights given in the element, in MuJoCo's binary file or as a PNG.
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "manyhands/model/io/image/png.h"
#include "manyhands/model/io/mjcf/mjcf_assets.h"

namespace manyhands::io {

namespace {

/// (nrow, ncol) as int32, then the heights as float32, row by row from the lowest y.
void read_binary(const MjcfElement& source, const std::string& bytes, int most, HeightField& field) {
  std::array<std::int32_t, 2> size{};
  if (bytes.size() >= sizeof size) std::memcpy(size.data(), bytes.data(), sizeof size);
  field.rows = size[0];
  field.columns = size[1];
  const bool bounded = field.rows >= 2 && field.columns >= 2 && field.rows <= most / field.columns;
  const std::size_t count =
      bounded ? static_cast<std::size_t>(field.rows) * static_cast<std::size_t>(field.columns) : 0;
  if (!bounded || bytes.size() != sizeof size + count * sizeof(float)) {
    source.fail("the file is no height field: expected two int32, nrow and ncol, and as many float32");
  }
  std::vector<float> heights(count);
  std::memcpy(heights.data(), bytes.data() + sizeof size, count * sizeof(float));
  field.height.assign(heights.begin(), heights.end());
}

/// Grey values; the rows run from the highest y down.
void read_picture(const std::string& bytes, int most, HeightField& field) {
  const GreyImage image = read_png(bytes, static_cast<std::size_t>(most));
  if (image.width < 2 || image.height < 2) throw ImageError("it has a single row or column of pixels; expected two");
  field.rows = static_cast<int>(image.height);
  field.columns = static_cast<int>(image.width);
  field.height.reserve(image.values.size());
  for (std::size_t row = image.height; row-- > 0;) {
    const auto first = image.values.begin() + static_cast<std::ptrdiff_t>(row * image.width);
    field.height.insert(field.height.end(), first, first + static_cast<std::ptrdiff_t>(image.width));
  }
}

/// The rows in the element run from the highest y down.
void read_elevation(const MjcfElement& source, int most, HeightField& field) {
  field.rows = source.integer_or("nrow", 0);
  field.columns = source.integer_or("ncol", 0);
  if (field.rows < 2 || field.columns < 2 || field.rows > most / field.columns) {
    source.fail("a height field of " + std::to_string(field.rows) + " x " + std::to_string(field.columns) +
                " heights; expected 2 x 2 to " + std::to_string(most) + ", with those before");
  }
  const auto columns = static_cast<std::size_t>(field.columns);
  const std::size_t count = static_cast<std::size_t>(field.rows) * columns;
  field.height.assign(count, 0.0);
  if (!source.has("elevation")) return;
  const std::vector<double> given = source.numbers("elevation", count, count);
  for (std::size_t from = 0, to = count; from < count; from += columns) {
    to -= columns;
    std::copy_n(given.begin() + static_cast<std::ptrdiff_t>(from), columns,
                field.height.begin() + static_cast<std::ptrdiff_t>(to));
  }
}

}  // namespace

HeightField read_height_field(const MjcfElement& source, const std::string& bytes, int most) {
  const std::vector<double> size = source.numbers("size", 4, 4);
  if (size.empty()) source.fail("attribute 'size' of <hfield> is missing");
  if (!(*std::ranges::min_element(size) > 0)) source.fail("the numbers of 'size' must be above 0");
  HeightField field;
  if (bytes.empty()) {
    read_elevation(source, most, field);
  } else if (source.text_or("content_type", "") == "image/png" || source.text("file").ends_with(".png")) {
    read_picture(bytes, most, field);
  } else {
    read_binary(source, bytes, most, field);
  }
  field.dx = 2 * size[0] / (field.columns - 1);
  field.dy = 2 * size[1] / (field.rows - 1);
  // MuJoCo scales the lowest to 0 and the highest to size[2].
  const auto [low, high] = std::ranges::minmax(field.height);
  const double range = high - low;
  for (double& height : field.height) height = range > 0 ? (height - low) / range * size[2] : 0.0;
  return field;
}

}  // namespace manyhands::io
