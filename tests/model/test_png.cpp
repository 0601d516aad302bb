// Pictures made by zlib: filters, interlacing, the budget of pixels, and thousands of damaged ones.
#include <gtest/gtest.h>

#include <charconv>
#include <string>
#include <utility>

#include "manyhands/model/io/image/png.h"
#include "tests/model/mutator.h"
#include "tests/model/urdf_testing.h"

namespace manyhands::testing {
namespace {

using io::GreyImage;
using io::ImageError;
using io::read_png;

constexpr std::size_t kMost = 10'000;

constexpr std::string_view kFiltered =
    "89504e470d0a1a0a0000000d4948445200000009000000070800000000fff038bc0000003c4944415478da636060e69136f0ce997c80"
    "919d99935f545a515d97491406980d85c52465e4955435580c61b20ceb37ed3e75ff97b4533ee31f98180081ea0d4913c6aa3c000000"
    "0049454e44ae426082";
constexpr std::string_view kInterlaced =
    "89504e470d0a1a0a0000000d494844520000000900000007080000000188f7082a000000584944415478da014d00b2ff0000c0003000"
    "70a030000c6c007cdc001c284c88dc00fc082c68bc00031b4b93001f3767af00738bbb0300ff17478f00070a13223752739ac7003f42"
    "4b5a6f8aabd2ff00afb2bbcadffa1b426f83f11b221a91d2cc0000000049454e44ae426082";
constexpr std::string_view kDynamic =
    "89504e470d0a1a0a0000000d494844520000002000000020080000000056112528000001954944415478da7d92d10d1d211003bd5403"
    "5403570d500d5069768e877452944860bcfe5a99912cfcf7c86219db52693ba4da66c8b54fe5a72fc5672c8b0a65a66675a711ca8ecd"
    "ca4ac39e1d87ca8add1e69a4595db64b74e92ec1a5b82c17d96e35ba9414e670f13193f9d8c914ccf7903f7e15fcf14b767329d5b115"
    "eb98c7a5e7b869c7c9ca4e2dd419c771cf3aaeeb38859676b111673dee37aedf38a43d6ad21c351eb75ac961f592ed386f2bb0897165"
    "4ce7e5be534865cc4093162bf2f4892ce53a5ca44a6b34a93a911dfb3793355aa349df6fe256f9660a93d668d2f628d166aff99bbd1d"
    "7e8ffd15e4d2e9afad409df6ca2753a82bd25f6a7ae88f4ebf99d47d97e03f5dfca717ce7fff93c9bcc4ece2d54dfaa3d36f26c83bbd"
    "d1e0e5f074fb4ef00793f077998453988453c11f4cc2df65124e611227f88349f8bb4cc2e96ff4ef5e90487fc7c1240e4e712f7797c1"
    "cbe465f4b8583afcb565f9324906a764023df803cccb24199c9209fe8010fe2e93e00893702af88349f8bb4c42274cc2a92e87ff52bd"
    "10022610fe98fc8e7f00804ef7c918f939860000000049454e44ae426082";

std::string bytes_of(std::string_view hex) {
  std::string bytes(hex.size() / 2, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    int byte = 0;
    std::from_chars(hex.data() + 2 * i, hex.data() + 2 * i + 2, byte, 16);
    bytes[i] = static_cast<char>(byte);
  }
  return bytes;
}

template <class Value>
void expect_values(const GreyImage& image, std::size_t width, std::size_t height, Value value) {
  ASSERT_EQ(image.width, width);
  ASSERT_EQ(image.height, height);
  for (std::size_t j = 0; j < height; ++j) {
    for (std::size_t i = 0; i < width; ++i) EXPECT_EQ(image.values[j * width + i], value(i, j)) << i << ", " << j;
  }
}

TEST(Png, FiltersAndInterlacingAreUndone) {
  const auto value = [](std::size_t i, std::size_t j) { return (3 * i * i + 7 * j * j) % 256; };
  expect_values(read_png(bytes_of(kFiltered), kMost), 9, 7, value);    // all five filters, a block of the fixed code
  expect_values(read_png(bytes_of(kInterlaced), kMost), 9, 7, value);  // a stored block
}

TEST(Png, BlocksMayHaveTheirOwnCode) {
  expect_values(read_png(bytes_of(kDynamic), kMost), 32, 32,
                [](std::size_t i, std::size_t j) { return i * j % 5 * 40 + (i ^ j) % 3; });
}

TEST(Png, NothingBeyondTheBudgetIsRead) {
  EXPECT_THROW((void)read_png(bytes_of(kFiltered), 62), ImageError);
  EXPECT_NO_THROW((void)read_png(bytes_of(kFiltered), 63));
  std::string wider = bytes_of(kFiltered);
  wider[16] = '\x7f';                                                     // the width's upper byte
  EXPECT_THROW((void)read_png(wider, std::size_t{1} << 62), ImageError);  // its data are far fewer
}

std::uint32_t check_sum(std::string_view bytes) {  // CRC-32 of PNG, annex D
  std::uint32_t sum = 0xffffffff;
  for (const char c : bytes) {
    sum ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1) != 0 ? 0xedb88320 ^ (sum >> 1) : sum >> 1;
  }
  return ~sum;
}

/// The picture with the check sums that its chunks should have: else nothing behind them would be looked at.
std::string with_check_sums(std::string png) {
  for (std::size_t at = 8; at + 12 <= png.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<std::uint8_t>(png[at + i]);
    if (length > png.size() - at - 12) break;
    const std::uint32_t sum = check_sum(std::string_view(png).substr(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) png[at + 8 + length + i] = static_cast<char>(sum >> (24 - 8 * i));
    at += 12 + length;
  }
  return png;
}

TEST(PngFuzz, PicturesLoadOrGiveTheOneError) {
  int read = 0;
  for (const std::string_view hex : {kFiltered, kInterlaced, kDynamic}) {
    expect_read_or_refused<ImageError>(bytes_of(hex), rounds(6000), [&](const std::string& mutant) {
      const GreyImage image = read_png(with_check_sums(mutant), kMost);
      ASSERT_EQ(image.values.size(), image.width * image.height);
      ++read;
    });
  }
  EXPECT_GT(read, 100);
}

}  // namespace
}  // namespace manyhands::testing
