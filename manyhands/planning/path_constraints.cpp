#include "manyhands/planning/path_constraints.h"

#include <array>
#include <numbers>
#include <numeric>

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/planning/checks.h"

namespace manyhands {

namespace {

using Vec = Vec3<double>;

constexpr std::size_t kStretchLanes = width_v<NativeLanes>;
constexpr double kLaneRounding = 5e-6;  // of lanes, by which bounds are tightened [1 or m]
constexpr double kLeastAngle = 0.01;    // above rounding, and wide enough for ways of sensible length [rad]
constexpr double kLeastWidth = 1e-3;    // [m]
constexpr double kRoom = 0.01;          // to spare where there is one bound only [m]

constexpr double kParallel = 1e-9;  // sine of the least angle that has an axis

Vec direction_of(const char* name, const Vec& v) {
  const double length = norm(v);
  if (!(length > 0) || !std::isfinite(length))
    throw std::invalid_argument(std::string(name) + " is (" + as_text(v.x) + ", " + as_text(v.y) + ", " + as_text(v.z) +
                                "), which has no direction");
  return (1 / length) * v;
}

Vec unit_perpendicular(const Vec& v) {
  const Vec across = cross(v, std::abs(v.x) < std::abs(v.z) ? Vec{1, 0, 0} : Vec{0, 0, 1});
  return (1 / norm(across)) * across;
}

using Numbers = std::vector<double>;

double inner_product(const Numbers& a, const Numbers& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void add_scaled(Numbers& to, double share, const Numbers& x) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += share * x[k];
}

}  // namespace

PathConstraint keep_axis(FrameId frame, const Vec& axis, const Vec& direction, double within) {
  if (!(within >= kLeastAngle && within <= std::numbers::pi))
    throw std::invalid_argument("within is " + as_text(within) + " rad; expected " + as_text(kLeastAngle) + " to pi");
  return {frame, true, direction_of("axis", axis), direction_of("direction", direction), std::cos(within), 2};
}

std::vector<PathConstraint> keep_position(FrameId frame, const Transform<double>& X_WR, const Vec& lower,
                                          const Vec& upper) {
  const std::array<Vec, 3> axes{X_WR.R.x, X_WR.R.y, X_WR.R.z};
  const std::array<double, 3> low{lower.x, lower.y, lower.z}, high{upper.x, upper.y, upper.z};
  std::vector<PathConstraint> found;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(high[k] - low[k] >= kLeastWidth))
      throw std::invalid_argument("bounds of position are " + as_text(low[k]) + " and " + as_text(high[k]) +
                                  " m; expected the upper one to be " + as_text(kLeastWidth) + " m more, or farther");
    if (!std::isfinite(low[k]) && !std::isfinite(high[k])) continue;
    const double origin = dot(axes[k], X_WR.p);
    found.push_back({frame, false, Vec::zero(), axes[k], origin + low[k], origin + high[k]});
  }
  return found;
}

PathConstraints::PathConstraints(const Model& model, const PlanningScene& scene,
                                 std::span<const PathConstraint> constraints)
    : scene_(scene),
      exact_(scene, scene.tree),
      lanes_(scene, scene.tree_in_float),
      linear_(scene.size()),
      none_(scene.size()) {
  planned_of_.assign(static_cast<std::size_t>(model.nv()), kNotPlanned);
  for (std::size_t k = 0; k < scene.size(); ++k) planned_of_[scene.dof(k)] = k;
  for (const PathConstraint& given : constraints) add(model.frame(given.frame), given);
  bends_.resize(rows_.size());
  orthogonal_.assign(rows_.size(), std::vector<double>(scene.size()));
  for (std::size_t b = 0; b < used_.size(); ++b) {
    if (used_[b]) bodies_.push_back(b);
  }
}

void PathConstraints::add(const Frame& frame, const PathConstraint& given) {
  const std::size_t body = scene_.carriers[frame.body.index()];
  const Transform<double> X_BF = inverse(body_pose(body, exact_.ws)) * frame_pose(frame.body, frame.X_BF, exact_.ws);
  const Vec of = given.is_axis ? X_BF.R * given.of : X_BF * given.of;
  Row row{body, given.is_axis, of, given.along, given.lower, given.upper, {}, {}, frame.name};
  row.reach = scene_.reach(body, static_cast<float>(norm(of)), static_cast<float>(std::hypot(of.x, of.y)));
  row.turn.assign(scene_.size(), 0.0f);
  used_.resize(scene_.tree.bodies.size(), false);
  bool moves = false;
  for (std::size_t b = body; b != 0; b = static_cast<std::size_t>(scene_.tree.bodies[b].parent)) {
    used_[b] = std::ranges::find(scene_.bodies, b) != scene_.bodies.end();
    const TreeBody<double>& link = scene_.tree.bodies[b];
    if (link.nv != 1 || planned_of_[static_cast<std::size_t>(link.iv)] == kNotPlanned) continue;
    const bool turns = link.type != JointType::kPrismatic;
    row.turn[planned_of_[static_cast<std::size_t>(link.iv)]] = turns ? 1.0f : 0.0f;
    moves = moves || turns || !given.is_axis;
  }
  if (!moves)
    throw std::invalid_argument("a constraint is on '" + frame.name + "', which no planned joint " +
                                (given.is_axis ? "turns" : "moves"));
  rows_.push_back(std::move(row));
}

template <class R>
void PathConstraints::place(std::span<R> q) {
  for (std::size_t k = 0; k < q.size(); ++k) exact_.q[scene_.coordinates[k]] = static_cast<double>(q[k]);
  for (const std::size_t b : bodies_) manyhands::place(scene_.tree, b, exact_.q.data(), exact_.ws);
}

template <Number T>
T PathConstraints::value(const Row& row, const Workspace<T>& ws) const {
  const Vec3<T> x = ws.R_WB[row.body] * broadcast<T>(row.of);
  return dot(broadcast<T>(row.along), row.is_axis ? x : x + ws.p_OB[row.body] + ws.p_WO[row.body]);
}

std::string PathConstraints::broken_at(std::span<const double> q) {
  place(q);
  for (const Row& row : rows_) {
    const double x = value(row, exact_.ws);
    if (x >= row.lower + kLaneRounding && x <= row.upper - kLaneRounding) continue;
    if (row.is_axis)
      return "the axis of '" + row.frame + "' is " + as_text(std::acos(clamp(x, -1.0, 1.0))) +
             " rad from its direction, and may be " + as_text(std::acos(row.lower));
    const Vec& e = row.along;
    return "'" + row.frame + "' is at " + as_text(x) + " m along (" + as_text(e.x) + ", " + as_text(e.y) + ", " +
           as_text(e.z) + "), its bounds are " + as_text(row.lower) + " and " + as_text(row.upper);
  }
  return {};
}

/// With s and b bounds of a coordinate's first and second derivative: of R a, (sum of s)^2 + sum of b over the joints
/// that turn; of a point, the sum over pairs of joints of s_j s_k times the reach of the outer one, and of reach b.
float PathConstraints::greatest_bend(const Row& row, const MotionPiece& motion) const {
  float turning = 0, bend = 0;  // turning: the sum of s over the joints nearer to the root
  for (std::size_t k = 0; k < scene_.size(); ++k) {
    const float s = greatest_speed(motion, k), b = manyhands::greatest_bend(motion, k), turn = row.turn[k];
    const float reach = row.is_axis ? turn : row.reach[k];
    bend += reach * (b + s * (turn * s + 2 * turning));
    turning += turn * s;
  }
  return bend;
}

bool PathConstraints::hold(const MotionPiece& motion) {
  for (std::size_t i = 0; i < rows_.size(); ++i) bends_[i] = greatest_bend(rows_[i], motion);
  open_.assign(1, {0.0f, 1.0f});
  while (!open_.empty()) {
    const auto [first, last] = open_.back();
    open_.pop_back();
    if (!look(motion, first, last)) return false;
  }
  return true;
}

bool PathConstraints::hold(std::span<const float> a, std::span<const float> b) {
  for (std::size_t k = 0; k < linear_.size(); ++k) linear_[k] = b[k] - a[k];
  return hold({a, linear_, none_});
}

/// Looks at lanes from one t to another; stretches in doubt become open ones. False once one is not kept, or in doubt
/// and too short to matter.
bool PathConstraints::look(const MotionPiece& motion, float first, float last) {
  const float step = (last - first) / static_cast<float>(kStretchLanes - 1);
  std::array<float, kStretchLanes> t{};
  for (std::size_t k = 0; k < kStretchLanes; ++k) t[k] = first + static_cast<float>(k) * step;
  for (std::size_t k = 0; k < scene_.size(); ++k)
    lanes_.q[scene_.coordinates[k]] = coordinate_at(motion, k, load<NativeLanes>(t.data()));
  for (const std::size_t b : bodies_) manyhands::place(scene_.tree_in_float, b, lanes_.q.data(), lanes_.ws);
  mask_t<NativeLanes> close(false);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const NativeLanes x = value(rows_[i], lanes_.ws);
    const NativeLanes room = min(x - constant<NativeLanes>(rows_[i].lower), constant<NativeLanes>(rows_[i].upper) - x);
    const float sag = bends_[i] * step * step / 8;
    if (any(mask_t<NativeLanes>(room < constant<NativeLanes>(kLaneRounding)))) return false;
    const mask_t<NativeLanes> near(room < constant<NativeLanes>(kLaneRounding) + NativeLanes(sag));
    if (any(near) && sag < static_cast<float>(kLaneRounding)) return false;
    close = close | near;
  }
  if (none(close)) return true;
  for (std::size_t k = 0; k + 1 < kStretchLanes; ++k) {
    if (lane(close, static_cast<int>(k)) || lane(close, static_cast<int>(k + 1))) open_.emplace_back(t[k], t[k + 1]);
  }
  return true;
}

/// By how much the number that a row bounds is to change, 0 where it is kept; and its gradient (n). Of an axis this is
/// the angle from its direction, which is nearly linear in q, as the cosine is not.
double PathConstraints::correction(const Row& row, std::span<double> gradient) const {
  const Workspace<double>& ws = exact_.ws;
  const double x = value(row, ws);
  if (x >= row.lower + 2 * kLaneRounding && x <= row.upper - 2 * kLaneRounding) return 0;
  const Vec a = ws.R_WB[row.body] * row.of, p_O = a + ws.p_OB[row.body];
  Vec turn = cross(row.along, a);
  const double sine = norm(turn);
  if (sine > kParallel)
    turn = (1 / sine) * turn;
  else
    turn = unit_perpendicular(a);
  for (const int i : scene_.tree.path_of(row.body)) {
    const auto dof = static_cast<std::size_t>(i);
    if (planned_of_[dof] == kNotPlanned) continue;
    const Motion<double>& S = ws.S[dof];
    gradient[planned_of_[dof]] = row.is_axis ? dot(turn, S.w) : dot(row.along, S.v + cross(S.w, p_O));
  }
  if (row.is_axis) return (std::acos(clamp(row.lower, -1.0, 1.0)) / 2) - std::atan2(sine, x);
  const double spare = std::min((row.upper - row.lower) / 4, kRoom);
  return x < row.lower + 2 * kLaneRounding ? row.lower + spare - x : row.upper - spare - x;
}

bool PathConstraints::project(std::span<float> q) {
  constexpr int kMostSteps = 30;
  constexpr double kDependent = 1e-4;   // a row that others nearly determine [rad or m, per unit of q]
  constexpr double kLongestStep = 0.5;  // [rad or m]
  const std::size_t n = q.size();
  Numbers &gradient = gradient_, &step = step_;
  for (int i = 0; i < kMostSteps; ++i) {
    place(q);
    step.assign(n, 0.0);
    bool is_kept = true;
    std::size_t corrected = 0;
    for (const Row& row : rows_) {
      gradient.assign(n, 0.0);
      const double wanted = correction(row, gradient);
      if (wanted == 0) continue;
      is_kept = false;
      // The shortest step that satisfies all rows so far: Gram and Schmidt's part of the gradient is the rest's alone.
      Numbers& own = orthogonal_[corrected];
      own = gradient;
      for (std::size_t j = 0; j < corrected; ++j) add_scaled(own, -inner_product(own, orthogonal_[j]), orthogonal_[j]);
      const double length = std::sqrt(inner_product(own, own));
      if (length < kDependent) continue;
      for (double& x : own) x /= length;
      add_scaled(step, (wanted - inner_product(gradient, step)) / length, own);
      ++corrected;
    }
    if (is_kept) return true;
    if (corrected == 0) return false;
    const double length = std::sqrt(inner_product(step, step)), share = std::min(1.0, kLongestStep / length);
    for (std::size_t k = 0; k < n; ++k)
      q[k] = static_cast<float>(clamp(static_cast<double>(q[k]) + share * step[k], scene_.lower[k], scene_.upper[k]));
  }
  return false;
}

}  // namespace manyhands
