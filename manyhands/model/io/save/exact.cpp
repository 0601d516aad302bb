#include "manyhands/model/io/save/exact.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>

#include "manyhands/model/io/save/save.h"

namespace manyhands::io {

namespace {

template <class Number>
std::string shortest(Number value) {
  if (!std::isfinite(value)) throw SaveError("a number is not finite, which a file cannot say: mend the model first");
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

using Four = std::array<double, 4>;

double apart(const Vec3<double>& a, const Vec3<double>& b) {
  return std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z);
}

/// How far to_matrix(q) * after is from R, all entries together. Only what is 0 is the same to the bit.
class RotationError {
 public:
  RotationError(const Mat3<double>& R, const Mat3<double>& after) : R_(R), after_(after) {}

  double operator()(const Four& q) const {
    const Mat3<double> m = to_matrix(Quat<double>{q[0], q[1], q[2], q[3]}) * after_;
    return apart(m.x, R_.x) + apart(m.y, R_.y) + apart(m.z, R_.z);
  }

 private:
  Mat3<double> R_, after_;
};

double unit_in_last_place(double x) {
  return std::nextafter(std::abs(x), std::numeric_limits<double>::infinity()) - std::abs(x);
}

struct Best {
  Four q;
  double error;
};

/// All neighbours up to `reach` units in the last place away. What is 0 stays 0.
template <class Error>
void search_neighbours(const Error& error_of, int reach, Best& best) {
  const Four start = best.q;
  const int width = 2 * reach + 1;
  std::array<int, 4> widths{};
  int count = 1;
  for (std::size_t i = 0; i < 4; ++i) count *= widths[i] = start[i] == 0 ? 1 : width;
  for (int code = 0; code < count && best.error > 0; ++code) {
    Four q = start;
    int rest = code;
    for (std::size_t i = 0; i < 4; rest /= widths[i++]) {
      const int steps = rest % widths[i] - widths[i] / 2;
      q[i] += steps * unit_in_last_place(start[i]);
    }
    const double error = error_of(q);
    if (error < best.error) best = {q, error};
  }
}

/// How far neighbours are searched where so many of the numbers are not 0: a few thousand of them.
constexpr std::array<int, 5> kReach{0, 1000, 30, 7, 3};

/// A walk from the best so far, always by the same numbers: steps of one unit in the last place to a few 2^-53, taken
/// where the error does not grow much.
template <class Error>
void search_around(const Error& error_of, Best& best) {
  constexpr int kMost = 3000, kRestart = 400;
  std::uint64_t bits = 88172645463325252u;  // xorshift: Marsaglia, 2003
  Best at = best;
  for (int i = 0; i < kMost && best.error > 0; ++i) {
    bits ^= bits << 13;
    bits ^= bits >> 7;
    bits ^= bits << 17;
    Four q = at.q;
    std::uint64_t rest = bits;
    for (double& x : q) {
      const auto direction = rest & 3, finer = (rest >> 2) & 15, is_small = (rest >> 6) & 1;
      rest >>= 7;
      if (direction > 1 || x == 0) continue;
      const double least = unit_in_last_place(x);
      const double step = is_small != 0 ? least : std::max(least, std::ldexp(1.0, -52 - static_cast<int>(finer)));
      x += direction == 0 ? step : -step;
    }
    const double error = error_of(q);
    if (error <= 1.2 * at.error) at = {q, error};
    if (error < best.error) best = {q, error};
    if (i % kRestart == kRestart - 1) at = best;
  }
}

template <class Error>
Quat<double> found_near(const Quat<double>& start, const Error& error_of) {
  Best best{{start.x, start.y, start.z, start.w}, 0};
  best.error = error_of(best.q);
  const auto moving = std::ranges::count_if(best.q, [](double x) { return x != 0; });
  if (best.error > 0) search_neighbours(error_of, 1, best);
  if (best.error > 0) search_neighbours(error_of, kReach[static_cast<std::size_t>(moving)], best);
  if (best.error > 0) search_around(error_of, best);
  return {best.q[0], best.q[1], best.q[2], best.q[3]};
}

}  // namespace

std::string exact_text(double value) { return shortest(value); }

std::string exact_text(float value) { return shortest(value); }

std::string exact_text(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += ' ';
    text += exact_text(value);
  }
  return text;
}

std::string exact_text(const Vec3<double>& v) { return exact_text(std::array{v.x, v.y, v.z}); }

Quat<double> quat_for(const Mat3<double>& R, const Mat3<double>& after) {
  return found_near(normalized(to_quat(R * transpose(after))), RotationError(R, after));
}

Quat<double> quat_for(const Quat<double>& wanted) {
  return found_near(normalized(wanted), [&](const Four& f) {
    const Quat<double> q = to_quat(to_matrix(Quat<double>{f[0], f[1], f[2], f[3]}));
    return std::abs(q.x - wanted.x) + std::abs(q.y - wanted.y) + std::abs(q.z - wanted.z) + std::abs(q.w - wanted.w);
  });
}

Vec3<double> vector_for(const Mat3<double>& R, const Vec3<double>& wanted) {
  const Vec3<double> start = transpose_times(R, wanted);
  const Quat<double> found = found_near(
      {start.x, start.y, start.z, 0}, [&](const Four& v) { return apart(R * Vec3<double>{v[0], v[1], v[2]}, wanted); });
  return {found.x, found.y, found.z};
}

Vec3<double> rpy_for(const Mat3<double>& R) {
  // Yaw first, and roll of what remains: near a pitch of 90 degrees only their sum counts.
  const double yaw = std::atan2(R.x.y, R.x.x), c = std::cos(yaw), s = std::sin(yaw);
  const double pitch = std::atan2(-R.x.z, c * R.x.x + s * R.x.y);
  const double roll = std::atan2(s * R.z.x - c * R.z.y, c * R.y.y - s * R.y.x);
  const Quat<double> found = found_near({roll, pitch, yaw, 0}, [&](const Four& rpy) {
    const Mat3<double> m = rotation_from_rpy(Vec3<double>{rpy[0], rpy[1], rpy[2]});
    return apart(m.x, R.x) + apart(m.y, R.y) + apart(m.z, R.z);
  });
  return {found.x, found.y, found.z};
}

bool same(const Vec3<double>& a, const Vec3<double>& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

bool same(const Mat3<double>& a, const Mat3<double>& b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }

}  // namespace manyhands::io
