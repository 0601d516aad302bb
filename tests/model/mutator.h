// Damaged copies of a text.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <string>
#include <string_view>
#include <utility>

namespace manyhands::testing {

/// Damages texts by chance, the same for the same seed.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string mutated(std::string_view seed) {
    std::string text(seed);
    for (std::size_t n = 1 + below(5); n > 0 && !text.empty(); --n) mutate(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }

  /// The next stretch from `open` to `close`, as a place and a length.
  std::pair<std::size_t, std::size_t> stretch(const std::string& text, char open, char close) {
    const std::size_t from = text.find(open, below(text.size()));
    const std::size_t to = from == text.npos ? from : text.find(close, from + 1);
    return to == text.npos ? std::pair<std::size_t, std::size_t>{0, 0} : std::pair{from, to - from + 1};
  }

  void mutate(std::string& text) {
    static constexpr std::string_view kMarks = "<>/\"'#=&;! -.0";
    static constexpr std::string_view kNumbers[] = {"0",     "-1",    "nan",      "1e308", "-1e-320", "4294967295",
                                                    "1e400", "-2147", "18446744", "0x10",  "1,2",     ""};
    const std::size_t at = below(text.size());
    switch (below(8)) {
      case 0:
        text[at] = static_cast<char>(random_());
        break;
      case 1:
        text[at] = kMarks[below(kMarks.size())];
        break;
      case 2:
        text.erase(at, 1 + below(30));
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), below(200)));
        break;
      case 4: {  // a number becomes another
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit != text.npos) text.replace(digit, 1, kNumbers[below(std::size(kNumbers))]);
        break;
      }
      case 5: {  // a tag goes
        const auto [from, size] = stretch(text, '<', '>');
        text.erase(from, size);
        break;
      }
      case 6: {  // an element comes twice, or somewhere else
        const auto [from, size] = stretch(text, '<', '>');
        text.insert(stretch(text, '<', '>').first, text.substr(from, size));
        break;
      }
      default: {  // a value takes another's place
        const auto [from, size] = stretch(text, '"', '"');
        const auto [other, other_size] = stretch(text, '"', '"');
        text.replace(from, size, text.substr(other, other_size));
        break;
      }
    }
  }

  std::mt19937 random_;
};

/// How many cases to run: MANYHANDS_FUZZ_ROUNDS, or else the usual number.
inline unsigned rounds(unsigned usual) {
  const char* const asked = std::getenv("MANYHANDS_FUZZ_ROUNDS");
  return asked == nullptr ? usual : static_cast<unsigned>(std::strtoul(asked, nullptr, 10));
}

/// Damaged copies of what is sound are either read, by `read(copy)`, or give the one Error; some of each.
template <class Error, class Read>
void expect_read_or_refused(std::string_view sound, unsigned count, Read&& read) {
  int loaded = 0, refused = 0;
  for (unsigned seed = 0; seed < count; ++seed) {
    try {
      read(Mutator(seed).mutated(sound));
      if (::testing::Test::HasFatalFailure()) return;
      ++loaded;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(loaded, 0);
  EXPECT_GT(refused, 0);
}

}  // namespace manyhands::testing
