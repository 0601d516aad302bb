#include "manyhands/planning/ball_cover.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>

namespace manyhands {

namespace {

using Vec = Vec3<double>;

constexpr double kNone = -1e3;  // of Ball::inner, where the centre may be outside

/// A box along the axes of a shape.
struct Box {
  Vec centre, half;
};

/// Of a shape, at least: along its own axes.
Box bounds_of(const ConvexShape& shape) {
  const auto reach = [&](const Vec& d) { return dot(shape.support(d), d) + shape.radius; };
  const Vec high{reach({1, 0, 0}), reach({0, 1, 0}), reach({0, 0, 1})};
  const Vec low{-reach({-1, 0, 0}), -reach({0, -1, 0}), -reach({0, 0, -1})};
  return {0.5 * (low + high), 0.5 * (high - low)};
}

std::pair<Box, Box> split(const Box& box) {
  const Vec& h = box.half;
  Vec half = h, shift = Vec::zero();
  double Vec::* const axis = h.x >= h.y && h.x >= h.z ? &Vec::x : h.y >= h.z ? &Vec::y : &Vec::z;
  half.*axis *= 0.5;
  shift.*axis = half.*axis;
  return {{box.centre - shift, half}, {box.centre + shift, half}};
}

/// What is to be covered, and from where it can be, in the common frame.
class Cells {
 public:
  Cells(std::span<const PlacedConvex> shapes, double overshoot) : shapes_(shapes), overshoot_(overshoot) {
    for (index_ = 0; index_ < shapes.size(); ++index_) {
      const Box box = bounds_of(shapes[index_].shape);
      finest_ = std::max(overshoot / 3, norm(box.half) / 50);
      divide(box);
    }
  }

  std::vector<Ball> cells;  ///< balls about cells
  std::vector<Ball> candidates;

 private:
  static constexpr double kShareOfDepth = 0.3;  // cells deep inside may be as large as this share of their depth

  void divide(const Box& box) {
    const PlacedConvex& own = shapes_[index_];
    const double radius = norm(box.half), depth = depth_within(own.shape, box.centre);
    if (depth < -radius) return;
    const Vec centre = own.X * box.centre;
    double deepest = depth;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      if (i == index_) continue;
      const double other = depth_within(shapes_[i].shape, inverse(shapes_[i].X) * centre);
      if (i < index_ && other >= radius) return;  // that shape's own cells are there
      deepest = std::max(deepest, other);
    }
    if (deepest > 0) candidates.push_back({centre, deepest + overshoot_, deepest});
    if (radius <= std::max(finest_, kShareOfDepth * depth)) {
      cells.push_back(depth < 0 ? part_within(own, box.centre, radius, -depth) : Ball{centre, radius, deepest});
      return;
    }
    const auto [low, high] = split(box);
    divide(low);
    divide(high);
  }

  /// What of a ball whose centre is outside, at a distance from a plane that bounds the shape: half a ball or less.
  [[nodiscard]] static Ball part_within(const PlacedConvex& own, const Vec& centre, double radius, double outside) {
    constexpr double kStep = 1e-6;
    const auto slope = [&](const Vec& along) {
      return depth_within(own.shape, centre + kStep * along) - depth_within(own.shape, centre - kStep * along);
    };
    const Vec inwards{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
    const Vec on_plane = centre + (outside / norm(inwards)) * inwards;
    return {own.X * on_plane, std::sqrt(std::max(0.0, radius * radius - outside * outside)) + kStep, kNone};
  }

  std::span<const PlacedConvex> shapes_;
  double overshoot_, finest_{};
  std::size_t index_{};
};

bool holds(const Ball& ball, const Ball& cell) {
  const double room = ball.radius - cell.radius;
  return room >= 0 && squared_norm(ball.centre - cell.centre) <= room * room;
}

/// Which cells each candidate holds, as bits.
class Coverage {
 public:
  Coverage(const std::vector<Ball>& candidates, const std::vector<Ball>& cells)
      : words_((cells.size() + 63) / 64), bits_(candidates.size() * words_), open_(words_, ~std::uint64_t{0}) {
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      for (std::size_t i = 0; i < cells.size(); ++i) {
        if (holds(candidates[c], cells[i])) row(c)[i / 64] |= std::uint64_t{1} << (i % 64);
      }
    }
  }

  /// How many cells that no candidate taken holds.
  [[nodiscard]] int gain(std::size_t candidate) const {
    const std::span<const std::uint64_t> held = row(candidate);
    int sum = 0;
    for (std::size_t k = 0; k < words_; ++k) sum += std::popcount(held[k] & open_[k]);
    return sum;
  }
  void take(std::size_t candidate) {
    const std::span<const std::uint64_t> held = row(candidate);
    for (std::size_t k = 0; k < words_; ++k) open_[k] &= ~held[k];
  }

 private:
  [[nodiscard]] std::span<std::uint64_t> row(std::size_t c) { return std::span(bits_).subspan(c * words_, words_); }
  [[nodiscard]] std::span<const std::uint64_t> row(std::size_t c) const {
    return std::span(bits_).subspan(c * words_, words_);
  }

  std::size_t words_;
  std::vector<std::uint64_t> bits_, open_;
};

/// Every so manieth, so that no more are left than `most`.
void thin_out(std::vector<Ball>& balls, std::size_t most) {
  if (balls.size() <= most) return;
  std::vector<Ball> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(balls[i * balls.size() / most]);
  balls = std::move(kept);
}

double deepest_within(std::span<const PlacedConvex> shapes, const Vec& p) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (const PlacedConvex& own : shapes) deepest = std::max(deepest, depth_within(own.shape, inverse(own.X) * p));
  return deepest;
}

/// Of cells that no ball holds yet, at edges mostly: balls between each of them and the nearest ball that was taken.
void cover_rest(std::span<const PlacedConvex> shapes, double overshoot, std::vector<Ball> cells,
                std::vector<Ball>& balls) {
  constexpr int kSteps = 12;
  std::erase_if(cells, [&](const Ball& cell) {
    return std::ranges::any_of(balls, [&](const Ball& ball) { return holds(ball, cell); });
  });
  const std::vector<Ball> inner = balls;
  while (!cells.empty()) {
    const Ball cell = cells.back();
    Vec way = Vec::zero();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Ball& ball : inner) {
      if (const double d = norm(ball.centre - cell.centre) - ball.radius; d < nearest) {
        nearest = d;
        way = ball.centre - cell.centre;
      }
    }
    Ball best = cell;
    std::ptrdiff_t most = 1;
    for (int step = 0; step < kSteps; ++step) {
      const Vec centre = cell.centre + (static_cast<double>(step) / kSteps) * way;
      const double depth = deepest_within(shapes, centre);
      const Ball ball{centre, depth + overshoot, depth};
      if (depth < 0 || !holds(ball, cell)) continue;
      const auto gain = std::ranges::count_if(cells, [&](const Ball& other) { return holds(ball, other); });
      if (gain < most) continue;
      most = gain;
      best = ball;
    }
    balls.push_back(best);
    std::erase_if(cells, [&](const Ball& other) { return holds(best, other); });
  }
}

}  // namespace

double depth_within(const ConvexShape& shape, const Vec3<double>& p) {
  const Vec& s = shape.size;
  switch (shape.core) {
    case ConvexShape::Core::kPoint:
      return shape.radius - norm(p);
    case ConvexShape::Core::kSegment:
      return shape.radius - norm(Vec{p.x, p.y, p.z - std::clamp(p.z, -s.y, s.y)});
    case ConvexShape::Core::kBox:
      return std::min({s.x - std::abs(p.x), s.y - std::abs(p.y), s.z - std::abs(p.z)}) + shape.radius;
    case ConvexShape::Core::kCylinder:
      return std::min(s.x - std::hypot(p.x, p.y), s.y - std::abs(p.z)) + shape.radius;
    case ConvexShape::Core::kHull: {
      double depth = std::numeric_limits<double>::infinity();
      for (const FacePlane& plane : shape.hull->planes) depth = std::min(depth, plane.offset - dot(plane.normal, p));
      return depth + shape.radius;
    }
    case ConvexShape::Core::kTriangle:
      break;
  }
  return -std::numeric_limits<double>::infinity();  // a triangle has no inside, and no link is one
}

std::vector<Ball> cover_with_balls(std::span<const PlacedConvex> shapes, double overshoot) {
  constexpr std::size_t kMostCandidates = 400;
  Cells made(shapes, overshoot);
  thin_out(made.candidates, kMostCandidates);
  Coverage coverage(made.candidates, made.cells);
  // Gains only fall, so that the best is known once one asked anew stays ahead of what others had.
  std::priority_queue<std::pair<int, std::size_t>> gains;
  for (std::size_t c = 0; c < made.candidates.size(); ++c) gains.emplace(coverage.gain(c), c);
  std::vector<Ball> balls;
  while (!gains.empty() && gains.top().first > 0) {
    const std::size_t best = gains.top().second;
    gains.pop();
    const int gain = coverage.gain(best);
    if (!gains.empty() && gain < gains.top().first) {
      gains.emplace(gain, best);
      continue;
    }
    if (gain == 0) break;
    coverage.take(best);
    balls.push_back(made.candidates[best]);
  }
  cover_rest(shapes, overshoot, made.cells, balls);
  return balls;
}

}  // namespace manyhands
