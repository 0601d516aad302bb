// How a constraint gives way instead of holding exactly.
#pragma once

#include <optional>
#include <tuple>

namespace manyhands {

/// MuJoCo's law of soft constraints. A row whose error is r [m or rad], and which moves by J v, meets a force f with
///     d/dt (J v) + (1 - d) / d W f = -damping / d_max (J v) - stiffness / d_max^2 d r,
/// where W = J M^-1 J^T is what the row moves per force at the model's start, as MuJoCo approximates it, and the
/// impedance d grows with |r| from `impedance` at 0 to `largest_impedance` = d_max at `width`. So it acts as a mass, a
/// damper and a spring, whatever it holds: a body that hangs on it by gravity g sinks by
/// (1 - d) d_max^2 g / (d^2 stiffness).
struct Compliance {
  double stiffness = 2500;           ///< [1/s^2]
  double damping = 100;              ///< [1/s]
  double impedance = 0.9;            ///< between 0 and 1, as all impedances: 1 would hold exactly
  double largest_impedance = 0.95;   ///< may be the lesser of the two
  double width = 0.001;              ///< [m or rad]
  double midpoint = 0.5, power = 2;  ///< the impedance follows x^power up to this part of the width, then its mirror
  double share = 1;                  ///< of a surface: what it counts in the mean of two that touch
  bool if_soft = false;              ///< of a surface: it acts only where that mean is clearly soft

  /// Its numbers, for the model's fingerprint.
  [[nodiscard]] auto fields() const {
    return std::tie(stiffness, damping, impedance, largest_impedance, width, midpoint, power, share);
  }
  [[nodiscard]] friend bool operator==(const Compliance&, const Compliance&) = default;
};

/// Which constraints of an MJCF file give way by solref and solimp; all others hold exactly.
enum class MjcfCompliance {
  kStated,  ///< those that the file or its classes make clearly softer than MuJoCo's default
  kAll,     ///< all that are soft in MuJoCo: limits, equality constraints and contacts, by default or not
  kNone,
};

/// Whether a load moves it at least twice as far as MuJoCo's default, where its error is 0 or beyond its width.
[[nodiscard]] bool is_soft(const Compliance& compliance);

/// Whether a surface with it can give way: not where it acts only if it is soft, and is not.
[[nodiscard]] bool gives_way(const std::optional<Compliance>& compliance);

/// MuJoCo's of two surfaces that touch: the mean of both, where one that has none counts as MuJoCo's default. None
/// where neither gives way by itself, or where the mean acts only if it is soft, and is not.
[[nodiscard]] std::optional<Compliance> between(const std::optional<Compliance>& a, const std::optional<Compliance>& b);

/// That which oscillates with this time constant [s] and ratio of damping: MuJoCo's solref.
[[nodiscard]] inline Compliance compliance_of(double time_constant, double damping_ratio) {
  const double rate = 1 / (time_constant * damping_ratio);
  return {.stiffness = rate * rate, .damping = 2 / time_constant};
}

}  // namespace manyhands
