// How good a step response is, and how far a loop is from instability.
#pragma once

#include <span>

namespace manyhands {

/// Of a response that is to go from `start` to `set_point` (Ogata, Modern Control Engineering, 2010, section 5-3), at
/// the samples that were given. What does not happen is infinite.
struct StepResponse {
  double rise_time;           ///< between the first samples at 10 % and at 90 % of the way [s]
  double settling_time;       ///< from when on the error is within the tolerance [s]
  double peak;                ///< the farthest of all samples
  double peak_time;           ///< [s]
  double overshoot;           ///< by how much it goes beyond, as a share of the way; 0 if it does not
  double steady_state_error;  ///< of the last sample: response - set_point
};

/// `tolerance`: as a share of the way. Throws std::invalid_argument unless time and response have the same length of 1
/// or more and times rise.
[[nodiscard]] StepResponse step_response(std::span<const double> time, std::span<const double> response,
                                         double set_point, double start, double tolerance);

/// Of a loop that is closed with negative feedback; infinite where there is no crossover.
struct StabilityMargins {
  double gain;  ///< by what factor the gain may grow; of an unstable loop, the crossover's that is nearest to 1
  double
      gain_frequency;  ///< at which it then oscillates: the phase is -180 degrees; 0 or infinite if it drifts [rad/s]
  double phase;        ///< by what angle its phase may fall [rad]
  double phase_frequency;       ///< where the gain is 1 [rad/s]
  bool stable;                  ///< whether the closed loop is: the margins of one that is not say what it lacks
  double lower_gain;            ///< to what factor, below 1, the gain may fall until it oscillates; 0 if it may vanish
  double lower_gain_frequency;  ///< at which it then oscillates [rad/s]
};

/// Of the loop L(s) = numerator(s) / denominator(s) exp(-delay s), coefficients of the highest power first. Where there
/// are several crossovers, the one that leaves least. Found by sweeping 10,000 frequencies over all corners of L and
/// bisection. A loop that is sampled with step h and held behaves as one with a delay of h / 2 more.
/// Stable: all poles of 1 / (1 + L) lie left of the imaginary axis. Without delay they are counted by the turn of
/// numerator + denominator along that axis (Mikhailov, 1938); each crossover of the gain then says how many cross as
/// the delay grows (Walton and Marshall, Direct method for TDS stability analysis, IEE Proc. D 134, 1987). A loop that
/// is at its limit without the delay is not called stable with it. Throws std::invalid_argument on empty or zero
/// polynomials, numbers that are not finite, and a negative delay.
[[nodiscard]] StabilityMargins stability_margins(std::span<const double> numerator, std::span<const double> denominator,
                                                 double delay);

}  // namespace manyhands
