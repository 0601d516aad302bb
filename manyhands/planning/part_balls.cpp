#include "manyhands/planning/part_balls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace manyhands {

namespace {

constexpr float kBallRounding = 1e-5f;   // of positions in single precision, generously [m]
constexpr std::size_t kBallsOfLeaf = 4;  // at most

std::pair<Vec3<float>, Vec3<float>> corners(std::span<const PartBall> balls) {
  Vec3<float> low = balls[0].centre, high = low;
  for (const PartBall& ball : balls) {
    const Vec3<float>& c = ball.centre;
    low = {min(low.x, c.x), min(low.y, c.y), min(low.z, c.z)};
    high = {max(high.x, c.x), max(high.y, c.y), max(high.z, c.z)};
  }
  return {low, high};
}

PartBall around(std::span<const PartBall> balls) {
  const auto [low, high] = corners(balls);
  PartBall bound{.centre = 0.5f * (low + high)};
  for (const PartBall& ball : balls) bound.radius = max(bound.radius, norm(ball.centre - bound.centre) + ball.radius);
  return bound;
}

/// Adds the node of balls [first, last), and below it those of their halves along the longest side.
void add_node(MovingPart& part, std::size_t first, std::size_t last) {
  const std::size_t node = part.nodes.size();
  const std::span<PartBall> balls = std::span(part.balls).subspan(first, last - first);
  part.nodes.push_back({around(balls), first, last});
  if (balls.size() <= kBallsOfLeaf) return;
  const auto [low, high] = corners(balls);
  const Vec3<float> side = high - low;
  float Vec3<float>::* const axis = side.x >= side.y && side.x >= side.z ? &Vec3<float>::x
                                    : side.y >= side.z                   ? &Vec3<float>::y
                                                                         : &Vec3<float>::z;
  const std::size_t half = balls.size() / 2;
  std::ranges::nth_element(balls, balls.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [axis](const PartBall& ball) { return ball.centre.*axis; });
  add_node(part, first, first + half);
  part.nodes[node].second = part.nodes.size();
  add_node(part, first + half, last);
}

/// The capsule around the balls whose axis has the direction `along`, a unit vector.
PartCapsule capsule_along(std::span<const PartBall> balls, const Vec3<float>& along) {
  const auto across = [&](const Vec3<float>& p) { return p - dot(p, along) * along; };
  std::vector<PartBall> flat(balls.begin(), balls.end());
  for (PartBall& ball : flat) ball.centre = across(ball.centre);
  const Vec3<float> foot = across(around(flat).centre);
  PartCapsule capsule;
  for (const PartBall& ball : flat) capsule.radius = max(capsule.radius, norm(ball.centre - foot) + ball.radius);
  capsule.radius += kBallRounding;
  // An end may stay behind the balls by as much as its own ball sticks out around them.
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const float t = dot(balls[i].centre, along), room = square(capsule.radius - balls[i].radius);
    const float before = std::sqrt(max(0.0f, room - squared_norm(flat[i].centre - foot)));
    low = min(low, t + before);
    high = max(high, t - before);
  }
  if (low > high) low = high = (low + high) / 2;
  capsule.a = foot + low * along;
  capsule.b = foot + high * along;
  return capsule;
}

/// The smallest of those along the sides and diagonals of a cube.
PartCapsule capsule_around(std::span<const PartBall> balls) {
  PartCapsule best;
  float least = std::numeric_limits<float>::infinity();
  for (int i = 1; i < 27; ++i) {
    const Vec3<float> along{static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1),
                            static_cast<float>(i / 9 - 1)};
    if (squared_norm(along) == 0) continue;
    const PartCapsule capsule = capsule_along(balls, (1 / norm(along)) * along);
    const float volume = square(capsule.radius) * (norm(capsule.b - capsule.a) + capsule.radius * 4 / 3);
    if (volume >= least) continue;
    least = volume;
    best = capsule;
  }
  return best;
}

}  // namespace

void internal::cover(MovingPart& part, double margin, double overshoot) {
  std::vector<PlacedConvex> shapes;
  for (const SceneGeom& geom : part.geoms) shapes.push_back({geom.shape.convex(), geom.X_BG});
  const auto more = static_cast<float>(margin);
  for (const Ball& ball : cover_with_balls(shapes, overshoot)) {
    part.balls.push_back({broadcast<float>(ball.centre), static_cast<float>(ball.radius) + more + kBallRounding,
                          static_cast<float>(ball.inner) + more - kBallRounding});
  }
  add_node(part, 0, part.balls.size());
  part.capsule = capsule_around(part.balls);
}

}  // namespace manyhands
