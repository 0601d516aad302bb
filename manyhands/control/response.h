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
  double gain;             ///< by what factor the loop's gain may grow until it oscillates; below 1 it does already
  double gain_frequency;   ///< at which it then oscillates: the phase is -180 degrees [rad/s]
  double phase;            ///< by what angle its phase may fall [rad]
  double phase_frequency;  ///< where the gain is 1 [rad/s]
};

/// Of the loop L(s) = numerator(s) / denominator(s) exp(-delay s), coefficients of the highest power first. Where there
/// are several crossovers, the one that leaves least. Found by sweeping 10,000 frequencies over all corners of L and
/// bisection. A loop that is sampled with step h and held behaves as one with a delay of h / 2 more.
/// Throws std::invalid_argument on empty or zero polynomials, numbers that are not finite, and a negative delay.
[[nodiscard]] StabilityMargins stability_margins(std::span<const double> numerator, std::span<const double> denominator,
                                                 double delay);

}  // namespace manyhands
