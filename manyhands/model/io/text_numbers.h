// Numbers from text, the same in every locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace manyhands::io {

/// One finite number that takes up the whole of `text`, without blanks; a leading + is allowed.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// The parts of `text` between blanks.
[[nodiscard]] std::vector<std::string_view> split_blanks(std::string_view text);

/// `text` in quotes, cut to a length that fits a message, unprintable characters replaced.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// A number as people write it: 0.001, not 1.000000e-03.
[[nodiscard]] std::string format_number(double value);

}  // namespace manyhands::io
