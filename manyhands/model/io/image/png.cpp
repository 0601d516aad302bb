// PNG pictures by libpng.
#include "manyhands/model/io/image/png.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <string>

namespace manyhands::io {

namespace {

/// What libpng's callbacks work on.
struct Source {
  std::string_view rest;  ///< bytes not yet read
  std::string error{};    ///< what went wrong
};

void take_bytes(png_structp png, png_bytep to, std::size_t count) {
  Source& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (count > source.rest.size()) png_error(png, "it ends too early");
  std::copy_n(source.rest.begin(), count, reinterpret_cast<char*>(to));
  source.rest.remove_prefix(count);
}

[[noreturn]] void keep_error(png_structp png, png_const_charp message) {
  static_cast<Source*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

/// libpng's reader and what it knows of the picture.
class Reader {
 public:
  explicit Reader(Source& source)
      : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, keep_error, ignore_warning)),
        info_(png_ == nullptr ? nullptr : png_create_info_struct(png_)) {
    if (info_ == nullptr) throw ImageError("there is no memory to read it");
    png_set_read_fn(png_, &source, take_bytes);
    png_set_chunk_malloc_max(png_, kMostOfAChunk);
  }
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // libpng leaves these by longjmp when something is wrong: they have no locals to destroy, and return false.

  /// Reads up to the pixels, and asks for them as grey values.
  bool read_header(std::size_t& width, std::size_t& height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_info(png_, info_);
    width = png_get_image_width(png_, info_);
    height = png_get_image_height(png_, info_);
    png_set_strip_16(png_);
    png_set_expand(png_);  // of a palette its colours, of few bits eight
    png_set_strip_alpha(png_);
    png_set_rgb_to_gray_fixed(png_, PNG_ERROR_ACTION_NONE, PNG_FP_1, 0);
    return true;
  }

  /// Reads the pixels, (height, width).
  bool read_pixels(std::uint8_t* pixels, std::size_t width, std::size_t height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    if (png_get_rowbytes(png_, info_) != width) png_error(png_, "its pixels do not become grey values");
    for (int pass = 0; pass < passes; ++pass) {
      for (std::size_t row = 0; row < height; ++row) png_read_row(png_, pixels + row * width, nullptr);
    }
    png_read_end(png_, nullptr);
    return true;
  }

 private:
  static constexpr png_alloc_size_t kMostOfAChunk = 1 << 20;  // [bytes] of what is no pixel

  png_structp png_;
  png_infop info_;
};

}  // namespace

GreyImage read_png(std::string_view bytes, std::size_t most_pixels) {
  constexpr std::size_t kSignature = 8;  // [bytes]
  const auto* const begin = reinterpret_cast<png_const_bytep>(bytes.data());
  if (bytes.size() < kSignature || png_sig_cmp(begin, 0, kSignature) != 0) {
    throw ImageError("it does not begin as a PNG does");
  }
  Source source{.rest = bytes};
  Reader reader(source);
  GreyImage image;
  if (!reader.read_header(image.width, image.height)) throw ImageError(source.error);
  if (image.width > most_pixels / image.height) {
    throw ImageError("it has " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                     " pixels; expected 1 to " + std::to_string(most_pixels));
  }
  image.values.resize(image.width * image.height);
  if (!reader.read_pixels(image.values.data(), image.width, image.height)) throw ImageError(source.error);
  return image;
}

}  // namespace manyhands::io
