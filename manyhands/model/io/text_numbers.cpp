#include "manyhands/model/io/text_numbers.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace manyhands::io {

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const char *const begin = text.data(), *const end = begin + text.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // Too small to be told from 0 is a number; too large is not.
    return text.find("e-") != text.npos || text.find("E-") != text.npos ? std::optional(0.0) : std::nullopt;
  }
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::vector<std::string_view> split_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n\v\f";
  std::vector<std::string_view> parts;
  for (std::size_t from = text.find_first_not_of(kBlanks); from != text.npos;) {
    const std::size_t to = std::min(text.find_first_of(kBlanks, from), text.size());
    parts.push_back(text.substr(from, to - from));
    from = text.find_first_not_of(kBlanks, to);
  }
  return parts;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  std::string result = "'";
  for (const char c : text.substr(0, kLongest)) {
    result += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  // A cut must not leave half a UTF-8 character behind.
  if (text.size() > kLongest) {
    while (result.size() > 1 && (static_cast<unsigned char>(result.back()) & 0xC0) == 0x80) result.pop_back();
    if (result.size() > 1 && (static_cast<unsigned char>(result.back()) & 0x80) != 0) result.pop_back();
    result += "...";
  }
  return result + "'";
}

std::string format_number(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

}  // namespace manyhands::io
