#include "manyhands/planning/part_balls.h"

#include <algorithm>
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
}

}  // namespace manyhands
