// Step responses and margins of systems whose formulas are known (Ogata, Modern Control Engineering, 2010).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "manyhands/control/response.h"

namespace manyhands {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(StepResponse, OfASecondOrderSystem) {
  const double damping = 0.4, frequency = 3, damped = frequency * std::sqrt(1 - damping * damping);
  std::vector<double> t, x;
  for (int i = 0; i <= 100'000; ++i) {
    t.push_back(1e-4 * i);
    const double phase = std::atan2(std::sqrt(1 - damping * damping), damping);
    x.push_back(2 - 2 * std::exp(-damping * frequency * t.back()) / std::sqrt(1 - damping * damping) *
                        std::sin(damped * t.back() + phase));
  }
  const StepResponse found = step_response(t, x, 2, 0, 0.02);
  EXPECT_NEAR(found.overshoot, std::exp(-damping * kPi / std::sqrt(1 - damping * damping)), 1e-6);
  EXPECT_NEAR(found.peak_time, kPi / damped, 2e-4);
  EXPECT_LT(found.settling_time, 4 / (damping * frequency));
  EXPECT_NEAR(found.steady_state_error, 0, 1e-4);
}

TEST(StepResponse, OfAFirstOrderSystemDownwards) {
  std::vector<double> t, x;
  for (int i = 0; i <= 10'000; ++i) {
    t.push_back(1e-3 * i);
    x.push_back(3 + 2 * std::exp(-t.back()));  // from 5 to 3
  }
  const StepResponse found = step_response(t, x, 3, 5, 0.02);
  EXPECT_NEAR(found.rise_time, std::log(9.0), 2e-3);
  EXPECT_NEAR(found.settling_time, std::log(50.0), 2e-3);
  EXPECT_EQ(found.overshoot, 0);
  const std::vector<double> short_t(t.begin(), t.begin() + 100), short_x(x.begin(), x.begin() + 100);
  EXPECT_TRUE(std::isinf(step_response(short_t, short_x, 3, 5, 0.02).rise_time));
  EXPECT_TRUE(std::isinf(step_response(short_t, short_x, 3, 5, 0.02).settling_time));
}

TEST(StabilityMargins, OfThreePoles) {
  const std::vector<double> numerator{2}, denominator{1, 3, 2, 0};  // 2 / (s (s + 1) (s + 2))
  const StabilityMargins found = stability_margins(numerator, denominator, 0);
  EXPECT_NEAR(found.gain, 3, 1e-9);
  EXPECT_NEAR(found.gain_frequency, std::sqrt(2.0), 1e-9);
  const double w = found.phase_frequency;
  EXPECT_NEAR(2 / (w * std::hypot(w, 1) * std::hypot(w, 2)), 1, 1e-9);
  EXPECT_NEAR(found.phase, kPi / 2 - std::atan(w) - std::atan(w / 2), 1e-9);
}

TEST(StabilityMargins, ADelayTakesPhase) {
  const std::vector<double> numerator{5}, denominator{1, 0};  // 5 / s, delayed: phase -90 degrees - w T
  const StabilityMargins found = stability_margins(numerator, denominator, 0.1);
  EXPECT_NEAR(found.phase, kPi / 2 - 0.5, 1e-9);
  EXPECT_NEAR(found.gain_frequency, kPi / 2 / 0.1, 1e-6);
  EXPECT_NEAR(found.gain, kPi / 2 / 0.1 / 5, 1e-6);
}

TEST(StabilityMargins, ALoopWithoutCrossoverHasNone) {
  const std::vector<double> numerator{1}, denominator{1, 2};
  const StabilityMargins found = stability_margins(numerator, denominator, 0);
  EXPECT_TRUE(std::isinf(found.gain) && std::isinf(found.phase));
  const std::vector<double> steep{1e9}, low{1, 1};
  EXPECT_NEAR(stability_margins(steep, low, 0).phase_frequency, 1e9, 1);
}

TEST(StabilityMargins, OfAnUnstablePlant) {
  const std::vector<double> plant{1, -1};  // k / (s - 1) closes to a pole at 1 - k
  const auto of = [&](double k) { return stability_margins(std::vector<double>{k}, plant, 0); };
  EXPECT_TRUE(of(2).stable);
  EXPECT_NEAR(of(2).lower_gain, 0.5, 1e-12);
  EXPECT_EQ(of(2).lower_gain_frequency, 0);
  EXPECT_TRUE(std::isinf(of(2).gain));
  EXPECT_FALSE(of(0.5).stable);
  EXPECT_NEAR(of(0.5).gain, 2, 1e-12);
  EXPECT_FALSE(of(1).stable);
  EXPECT_NEAR(of(1).gain, 1, 1e-12);
}

TEST(StabilityMargins, StableByRouth) {
  for (const double k : {0.5, 5.9, 5.999999, 6.000001, 10.0}) {  // k / (s (s + 1) (s + 2)) is below 6
    const StabilityMargins found = stability_margins(std::vector<double>{k}, std::vector<double>{1, 3, 2, 0}, 0);
    EXPECT_EQ(found.stable, k < 6) << k;
    EXPECT_NEAR(found.gain, 6 / k, 1e-9);
    EXPECT_EQ(found.phase > 0, found.stable);
  }
  // k (s + 1)^2 / s^3 needs s^3 + k s^2 + 2 k s + k to have 2 k > 1, and no least gain above.
  for (const double k : {0.4, 0.6}) {
    const StabilityMargins found =
        stability_margins(std::vector<double>{0, k, 2 * k, k}, std::vector<double>{1, 0, 0, 0}, 0);
    EXPECT_EQ(found.stable, k > 0.5) << k;
    EXPECT_NEAR(k > 0.5 ? found.lower_gain : found.gain, 0.5 / k, 1e-9);
  }
}

TEST(StabilityMargins, RandomLoopsAreStableWhereTheirPolesAre) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> in(-2, 1), gain(0.1, 10);
  for (int i = 0; i < 200; ++i) {  // (s - a)(s^2 - 2 b s + b^2 + c^2) is closed; any share of it is the numerator
    const double a = in(random), b = in(random), c = 3 * in(random), size = b * b + c * c;
    const std::vector<double> closed{1, -a - 2 * b, size + 2 * a * b, -a * size};
    const std::vector<double> numerator{gain(random), gain(random), gain(random)};
    std::vector<double> denominator = closed;
    for (std::size_t k = 0; k < 3; ++k) denominator[k + 1] -= numerator[k];
    EXPECT_EQ(stability_margins(numerator, denominator, 0).stable, a < 0 && b < 0) << a << ' ' << b << ' ' << c;
  }
}

TEST(StabilityMargins, ADelayDestabilisesAndStabilises) {
  const std::vector<double> integrator{1, 0}, minus{-1}, five{5};
  for (const double delay : {0.01, 0.3, 0.32, 3.0, 1e4})  // 5 / s: until 5 T = pi / 2
    EXPECT_EQ(stability_margins(five, integrator, delay).stable, 5 * delay < kPi / 2) << delay;
  // 1 - exp(-T s) / (s^2 - 0.1 s + 2): unstable without delay, stable where it is a derivative of the right sign.
  const std::vector<double> growing{1, -0.1, 2};
  EXPECT_FALSE(stability_margins(minus, growing, 0).stable);
  EXPECT_TRUE(stability_margins(minus, growing, 0.5).stable);
  EXPECT_FALSE(stability_margins(minus, growing, 3.0).stable);
  EXPECT_FALSE(stability_margins(std::vector<double>{2, 1}, std::vector<double>{1, 1}, 0.1).stable);
  EXPECT_TRUE(stability_margins(std::vector<double>{0.5, 1}, std::vector<double>{1, 2}, 0.1).stable);
}

TEST(StabilityMargins, NonsenseIsRefused) {
  const std::vector<double> one{1}, none, zero{0, 0};
  EXPECT_THROW((void)stability_margins(one, none, 0), std::invalid_argument);
  EXPECT_THROW((void)stability_margins(one, zero, 0), std::invalid_argument);
  EXPECT_THROW((void)stability_margins(one, one, -1), std::invalid_argument);
  const std::vector<double> falling{1, 0};
  EXPECT_THROW((void)step_response(falling, falling, 1, 0, 0.02), std::invalid_argument);
  EXPECT_THROW((void)step_response(none, none, 1, 0, 0.02), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
