// Refusals that the planning functions share: they name the array, the row and the number.
#pragma once

#include <span>
#include <stdexcept>
#include <string>

namespace manyhands {

/// For messages: as few digits as say which number it is.
[[nodiscard]] std::string as_text(double number);

/// Throws std::invalid_argument, which says where, if one of the rows of `width` numbers holds NaN or infinity.
void require_finite(const char* name, std::span<const double> numbers, std::size_t width);

/// Throws std::invalid_argument unless there are two times or more, rising from 0.
void require_times(const char* name, std::span<const double> times);

/// Throws std::invalid_argument unless there are `width` limits, all above 0. Infinite ones are none.
void require_limits(const char* name, std::span<const double> limits, std::size_t width);

/// Throws std::invalid_argument unless `numbers` are `rows` rows of `width`, all finite.
void require_rows(const char* name, std::span<const double> numbers, std::size_t rows, std::size_t width);

}  // namespace manyhands
