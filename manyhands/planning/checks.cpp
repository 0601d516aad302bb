#include "manyhands/planning/checks.h"

#include <cmath>
#include <cstdio>

namespace manyhands {

std::string as_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", number);
  return text;
}

void require_finite(const char* name, std::span<const double> numbers, std::size_t width) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (std::isfinite(numbers[i])) continue;
    throw std::invalid_argument(std::string(name) + " holds " + as_text(numbers[i]) + " in row " +
                                std::to_string(i / width) + ", column " + std::to_string(i % width) +
                                "; expected finite numbers");
  }
}

void require_times(const char* name, std::span<const double> times) {
  const std::string text(name);
  if (times.size() < 2) throw std::invalid_argument(text + " has fewer than two numbers");
  require_finite(name, times, 1);
  if (times[0] != 0) throw std::invalid_argument(text + " begins at " + as_text(times[0]) + "; expected 0");
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    throw std::invalid_argument(text + " must rise, but number " + std::to_string(i) + " is " + as_text(times[i]) +
                                " after " + as_text(times[i - 1]));
  }
}

namespace {

void require_count(const char* name, std::size_t found, std::size_t rows, std::size_t width) {
  if (found == rows * width) return;
  throw std::invalid_argument(std::string(name) + " has " + std::to_string(found) + " numbers; expected " +
                              std::to_string(rows) + " rows of " + std::to_string(width));
}

}  // namespace

void require_limits(const char* name, std::span<const double> limits, std::size_t width) {
  require_count(name, limits.size(), 1, width);
  for (std::size_t i = 0; i < width; ++i) {
    if (limits[i] > 0) continue;
    throw std::invalid_argument(std::string(name) + " limit " + std::to_string(i) + " is " + as_text(limits[i]) +
                                "; expected a number above 0, or infinity for none");
  }
}

void require_rows(const char* name, std::span<const double> numbers, std::size_t rows, std::size_t width) {
  require_count(name, numbers.size(), rows, width);
  require_finite(name, numbers, width);
}

}  // namespace manyhands
