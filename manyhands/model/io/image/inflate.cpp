#include "manyhands/model/io/image/inflate.h"

#include <array>
#include <span>

namespace manyhands::io {

namespace {

constexpr std::size_t kLongestCode = 15;

/// Bits from the lowest of each byte up.
class Bits {
 public:
  explicit Bits(std::string_view bytes) : bytes_(bytes) {}

  std::uint32_t take(int count) {
    while (held_ < count) {
      if (at_ == bytes_.size()) throw ImageError("the compressed data end too early");
      bits_ |= std::uint32_t{static_cast<std::uint8_t>(bytes_[at_++])} << held_;
      held_ += 8;
    }
    const std::uint32_t result = bits_ & ((1u << count) - 1);
    bits_ >>= count;
    held_ -= count;
    return result;
  }
  void skip_to_byte() {
    bits_ = 0;
    held_ = 0;
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::uint32_t bits_ = 0;
  int held_ = 0;
};

/// A canonical Huffman code, given by the length of each symbol's code.
class Huffman {
 public:
  explicit Huffman(std::span<const std::uint8_t> lengths) : symbols_(lengths.size()) {
    for (const std::uint8_t length : lengths) ++counts_[length];
    counts_[0] = 0;
    std::array<std::uint32_t, kLongestCode + 2> start{};
    int left = 1;
    for (std::size_t n = 1; n <= kLongestCode; ++n) {
      left = 2 * left - static_cast<int>(counts_[n]);
      if (left < 0) throw ImageError("a Huffman code has too many words");
      start[n + 1] = start[n] + counts_[n];
    }
    for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
      if (lengths[symbol] > 0) symbols_[start[lengths[symbol]]++] = static_cast<std::uint16_t>(symbol);
    }
  }

  std::uint32_t decode(Bits& bits) const {
    std::uint32_t code = 0, first = 0, index = 0;
    for (std::size_t n = 1; n <= kLongestCode; ++n) {
      code |= bits.take(1);
      if (code < first + counts_[n]) return symbols_[index + code - first];
      index += counts_[n];
      first = (first + counts_[n]) << 1;
      code <<= 1;
    }
    throw ImageError("the compressed data hold a code that has no meaning");
  }

 private:
  std::array<std::uint32_t, kLongestCode + 1> counts_{};
  std::vector<std::uint16_t> symbols_;
};

struct Codes {
  Huffman literals, distances;
};

Codes fixed_codes() {
  std::array<std::uint8_t, 288> literals{};
  for (std::size_t i = 0; i < literals.size(); ++i) literals[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
  std::array<std::uint8_t, 30> distances{};
  distances.fill(5);
  return {Huffman(literals), Huffman(distances)};
}

/// The code lengths of a block are compressed themselves, by a code whose lengths come first.
Codes read_codes(Bits& bits) {
  constexpr std::array<std::uint8_t, 19> kOrder{16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  const std::size_t num_literals = bits.take(5) + 257, num_distances = bits.take(5) + 1, num_lengths = bits.take(4) + 4;
  if (num_literals > 286 || num_distances > 30) throw ImageError("a block has more symbols than there are");
  std::array<std::uint8_t, 19> of_lengths{};
  for (std::size_t i = 0; i < num_lengths; ++i) of_lengths[kOrder[i]] = static_cast<std::uint8_t>(bits.take(3));
  const Huffman code(of_lengths);
  std::vector<std::uint8_t> lengths;
  while (lengths.size() < num_literals + num_distances) {
    const std::uint32_t symbol = code.decode(bits);
    if (symbol < 16) {
      lengths.push_back(static_cast<std::uint8_t>(symbol));
      continue;
    }
    if (symbol == 16 && lengths.empty()) throw ImageError("a block repeats a length before the first");
    const std::uint8_t repeated = symbol == 16 ? lengths.back() : std::uint8_t{0};
    const std::size_t times = symbol == 16 ? 3 + bits.take(2) : symbol == 17 ? 3 + bits.take(3) : 11 + bits.take(7);
    lengths.insert(lengths.end(), times, repeated);
  }
  if (lengths.size() > num_literals + num_distances) throw ImageError("a block has too many code lengths");
  const std::span all(lengths);
  return {Huffman(all.first(num_literals)), Huffman(all.subspan(num_literals))};
}

class Inflater {
 public:
  Inflater(std::string_view stream, std::size_t size) : bits_(stream), size_(size) {}

  std::vector<std::uint8_t> run() {
    const std::uint32_t method = bits_.take(8), flags = bits_.take(8);
    if ((method & 15) != 8 || (flags & 32) != 0 || (method * 256 + flags) % 31 != 0) {
      throw ImageError("the compressed data do not begin as zlib's do");
    }
    for (bool is_last = false; !is_last;) {
      is_last = bits_.take(1) == 1;
      const std::uint32_t kind = bits_.take(2);
      if (kind == 3) throw ImageError("the compressed data hold a block of an unknown kind");
      if (kind == 0) {
        copy_stored();
      } else {
        read_block(kind == 1 ? fixed_codes() : read_codes(bits_));
      }
    }
    if (bytes_.size() != size_) throw ImageError("the compressed data hold less than the picture");
    return std::move(bytes_);
  }

 private:
  void put(std::uint8_t byte) {
    if (bytes_.size() == size_) throw ImageError("the compressed data hold more than the picture");
    bytes_.push_back(byte);
  }

  void copy_stored() {
    bits_.skip_to_byte();
    const std::uint32_t count = bits_.take(16), inverse = bits_.take(16);
    if ((count ^ inverse) != 0xffff) throw ImageError("a stored block has a wrong length");
    for (std::uint32_t i = 0; i < count; ++i) put(static_cast<std::uint8_t>(bits_.take(8)));
  }

  void read_block(const Codes& codes) {
    constexpr std::uint32_t kEnd = 256;
    for (std::uint32_t symbol = codes.literals.decode(bits_); symbol != kEnd; symbol = codes.literals.decode(bits_)) {
      if (symbol < kEnd) {
        put(static_cast<std::uint8_t>(symbol));
      } else {
        repeat(symbol - kEnd - 1, codes.distances);
      }
    }
  }

  /// Puts again what stands a distance before.
  void repeat(std::uint32_t symbol, const Huffman& distances) {
    constexpr std::array<std::uint16_t, 29> kLengths{3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                                     31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
    constexpr std::array<std::uint16_t, 30> kDistances{1,    2,    3,    4,    5,    7,    9,    13,    17,    25,
                                                       33,   49,   65,   97,   129,  193,  257,  385,   513,   769,
                                                       1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
    if (symbol >= kLengths.size()) throw ImageError("a block repeats an unknown length");
    const bool is_longest = symbol + 1 == kLengths.size();
    const std::uint32_t length_bits = symbol < 8 || is_longest ? 0 : symbol / 4 - 1;
    const std::uint32_t length = kLengths[symbol] + bits_.take(static_cast<int>(length_bits));
    const std::uint32_t far = distances.decode(bits_);
    if (far >= kDistances.size()) throw ImageError("a block repeats from an unknown distance");
    const std::size_t distance = kDistances[far] + bits_.take(static_cast<int>(far < 4 ? 0 : far / 2 - 1));
    if (distance > bytes_.size()) throw ImageError("a block repeats what comes before the picture");
    for (std::uint32_t i = 0; i < length; ++i) put(bytes_[bytes_.size() - distance]);
  }

  Bits bits_;
  std::size_t size_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::vector<std::uint8_t> inflated(std::string_view stream, std::size_t size) { return Inflater(stream, size).run(); }

}  // namespace manyhands::io
