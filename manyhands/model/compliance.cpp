#include "manyhands/model/compliance.h"

#include <algorithm>
#include <cmath>

namespace manyhands {

namespace {

constexpr double kLeastShare = 1e-15;  // MuJoCo's mjMINVAL

/// The part of a in the mean of both.
double share_of(const Compliance& a, const Compliance& b) {
  if (a.share < kLeastShare && b.share < kLeastShare) return 0.5;
  return a.share / (a.share + b.share);
}

/// Stiffness against a load at the impedance d, per mobility of the row [1/s^2].
double stiffness_at(const Compliance& c, double d) {
  const double most = c.largest_impedance;
  return c.stiffness * d * d / (most * most * (1 - d));
}

}  // namespace

bool is_soft(const Compliance& c) {
  constexpr double kClearly = 2;
  const Compliance usual;
  const auto is_softer = [&](double d, double usual_d) {
    return kClearly * stiffness_at(c, d) <= stiffness_at(usual, usual_d);
  };
  return is_softer(c.impedance, usual.impedance) || is_softer(c.largest_impedance, usual.largest_impedance);
}

bool gives_way(const std::optional<Compliance>& compliance) {
  return compliance && (!compliance->if_soft || is_soft(*compliance));
}

std::optional<Compliance> between(const std::optional<Compliance>& a, const std::optional<Compliance>& b) {
  if (!gives_way(a) && !gives_way(b)) return std::nullopt;
  const Compliance one = a.value_or(Compliance()), other = b.value_or(Compliance());
  const double part = share_of(one, other);
  const auto mean = [&](double x, double y) { return part * x + (1 - part) * y; };
  const bool oscillate = std::min({one.stiffness, one.damping, other.stiffness, other.damping}) > 0;
  const auto ratio = [](const Compliance& c) { return c.damping / (2 * std::sqrt(c.stiffness)); };
  Compliance result = oscillate
                          ? compliance_of(mean(2 / one.damping, 2 / other.damping), mean(ratio(one), ratio(other)))
                          : Compliance{.stiffness = std::max(one.stiffness, other.stiffness),
                                       .damping = std::max(one.damping, other.damping)};
  result.impedance = mean(one.impedance, other.impedance);
  result.largest_impedance = mean(one.largest_impedance, other.largest_impedance);
  result.width = mean(one.width, other.width);
  result.midpoint = mean(one.midpoint, other.midpoint);
  result.power = mean(one.power, other.power);
  const bool acts = (a && !a->if_soft) || (b && !b->if_soft) || is_soft(result);
  return acts ? std::optional(result) : std::nullopt;
}

}  // namespace manyhands
