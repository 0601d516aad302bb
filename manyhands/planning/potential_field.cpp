#include "manyhands/planning/potential_field.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace manyhands {

namespace {

constexpr double kTouching = 1e-10;

double squared_distance(std::span<const double> a, const double* b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum = std::fma(a[i] - b[i], a[i] - b[i], sum);
  return sum;
}

void require_goal(std::span<const double> q, std::span<const double> goal) {
  if (q.size() == goal.size()) return;
  throw std::invalid_argument("q has " + std::to_string(q.size()) + " numbers and the goal " +
                              std::to_string(goal.size()) + "; expected as many");
}

/// Calls visit(obstacle, distance) for all in whose influence q lies.
template <class Visit>
void visit_near(std::span<const double> q, std::span<const double> obstacles, double influence, Visit&& visit) {
  if (q.empty() || obstacles.size() % q.size() != 0)
    throw std::invalid_argument("obstacles hold " + std::to_string(obstacles.size()) + " numbers; expected rows of " +
                                std::to_string(q.size()));
  const double far = influence * influence;
  for (std::size_t i = 0; i < obstacles.size(); i += q.size()) {
    const double squared = squared_distance(q, &obstacles[i]);
    if (squared <= far) visit(&obstacles[i], std::sqrt(squared));
  }
}

}  // namespace

double PotentialField::attractive(std::span<const double> q, std::span<const double> goal) const {
  require_goal(q, goal);
  return 0.5 * attractive_gain * squared_distance(q, goal.data());
}

double PotentialField::repulsive(std::span<const double> q, std::span<const double> obstacles) const {
  double sum = 0;
  visit_near(q, obstacles, influence, [&](const double*, double distance) {
    const double closer = 1 / distance - 1 / influence;
    sum += 0.5 * repulsive_gain * closer * closer;
  });
  return sum;
}

std::vector<double> PotentialField::gradient(std::span<const double> q, std::span<const double> goal,
                                             std::span<const double> obstacles) const {
  require_goal(q, goal);
  std::vector<double> slope(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) slope[i] = attractive_gain * (q[i] - goal[i]);
  visit_near(q, obstacles, influence, [&](const double* obstacle, double distance) {
    if (distance < kTouching) {
      slope[0] += repulsive_gain;
      return;
    }
    const double push = repulsive_gain * (1 / distance - 1 / influence) / (distance * distance * distance);
    for (std::size_t i = 0; i < q.size(); ++i) slope[i] = std::fma(-push, q[i] - obstacle[i], slope[i]);
  });
  return slope;
}

}  // namespace manyhands
