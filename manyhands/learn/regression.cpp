#include "manyhands/learn/regression.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "manyhands/learn/random.h"

namespace manyhands::learn {

namespace {

void demand(bool holds, const std::string& complaint) {
  if (!holds) throw std::invalid_argument("Regression: " + complaint);
}

RegressionConfig validated(RegressionConfig config) {
  config.validate();
  return config;
}

std::vector<int> regression_layers(int inputs, const std::vector<int>& hidden, int outputs) {
  std::vector<int> sizes = {inputs};
  sizes.insert(sizes.end(), hidden.begin(), hidden.end());
  sizes.push_back(outputs);
  return sizes;
}

}  // namespace

void RegressionConfig::validate() const {
  demand(num_threads >= 1, "num_threads is " + std::to_string(num_threads) + ", expected 1 or more");
  demand(std::ranges::all_of(hidden_layers, [](int units) { return units > 0; }),
         "hidden_layers holds a layer without units, expected 1 or more in each");
  demand(batch_size >= 2 && batch_size % 2 == 0,
         "batch_size is " + std::to_string(batch_size) + ", expected an even number, 2 or more");
  demand(learning_rate > 0 && std::isfinite(learning_rate), "learning_rate must be positive");
  demand(averaging_rate > 0 && averaging_rate <= 1, "averaging_rate must lie in (0, 1]");
}

Regression::Regression(std::vector<float> inputs, int input_dim, std::vector<float> targets, int output_dim,
                       const RegressionConfig& config)
    : config_(validated(config)),
      inputs_(std::move(inputs)),
      targets_(std::move(targets)),
      input_dim_(input_dim),
      output_dim_(output_dim),
      net_(regression_layers(input_dim, config_.hidden_layers, output_dim),
           config_.bounded ? OutputActivation::kTanh : OutputActivation::kLinear),
      average_(net_),
      optimiser_(net_.num_parameters(), config_.learning_rate),
      threads_(config_.num_threads) {
  const std::size_t pairs = inputs_.size() / static_cast<std::size_t>(input_dim);
  demand(pairs > 0, "there are no pairs to learn from");
  demand(pairs <= std::numeric_limits<std::uint32_t>::max(), "there are more than 2^32 pairs");
  demand(inputs_.size() == pairs * static_cast<std::size_t>(input_dim) &&
             targets_.size() == pairs * static_cast<std::size_t>(output_dim),
         "inputs and targets do not have the same number of rows");
  demand(std::ranges::all_of(inputs_, [](float x) { return std::isfinite(x); }), "an input is not finite");
  demand(std::ranges::none_of(targets_, [](float y) { return std::isinf(y); }), "a target is infinite");
  pairs_ = static_cast<std::uint32_t>(pairs);
  net_.initialise(derive_seed(config_.seed, Purpose::kActorSeed, 0), 0.1f);
  average_ = net_;
  for (Half& half : halves_) {
    half.tape = net_.make_tape(config_.batch_size / 2);
    half.gradient.setZero(net_.num_parameters());
  }
}

double Regression::advance(int steps) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) sum += step();
  if (!std::isfinite(sum)) {
    throw DivergenceError("Regression: the network diverged within " + std::to_string(optimiser_.step_count()) +
                          " steps (the loss is not finite); try a smaller learning rate");
  }
  return steps > 0 ? sum / steps : 0;
}

/// Returns the loss before the step.
double Regression::step() {
  threads_.run([&](int half) { compute_gradient(half); });
  optimiser_.begin_step();
  threads_.run([&](int part) { apply(part); });
  return (halves_[0].squared_error + halves_[1].squared_error) / (1.0 * config_.batch_size * output_dim_);
}

/// Of the mean over batch and outputs, from pairs that this half draws by itself.
void Regression::compute_gradient(int half) {
  Half& own = halves_[static_cast<std::size_t>(half)];
  Matrix<float>&input = own.tape.input(), &slope = own.tape.output_gradient();
  Random random(config_.seed, Purpose::kSampling, static_cast<std::uint64_t>(2 * optimiser_.step_count() + half));
  // Targets wait where their gradient will be.
  for (Eigen::Index column = 0; column < input.cols(); ++column) {
    const std::size_t pair = random.below(pairs_);
    std::copy_n(inputs_.data() + pair * static_cast<std::size_t>(input_dim_), input_dim_, input.col(column).data());
    std::copy_n(targets_.data() + pair * static_cast<std::size_t>(output_dim_), output_dim_, slope.col(column).data());
  }
  net_.forward(own.tape);
  const float weight = 2.0f / static_cast<float>(config_.batch_size * output_dim_);
  own.squared_error = 0;
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    const float error = std::isnan(slope(i)) ? 0.0f : own.tape.output()(i) - slope(i);
    own.squared_error += static_cast<double>(error) * static_cast<double>(error);
    slope(i) = weight * error;
  }
  net_.backward(own.tape, {.parameters = true, .input = false}, own.gradient);
}

/// Adds the gradients of both halves, in fixed order, and moves one of two parts of the parameters.
void Regression::apply(int part) {
  const int middle = net_.num_parameters() / 2;
  const int begin = part == 0 ? 0 : middle, end = part == 0 ? middle : net_.num_parameters();
  halves_[0].gradient.segment(begin, end - begin) += halves_[1].gradient.segment(begin, end - begin);
  optimiser_.apply(net_.parameters(), halves_[0].gradient, begin, end);
  polyak_average(average_.parameters(), net_.parameters(), config_.averaging_rate, begin, end);
}

}  // namespace manyhands::learn
