#include "manyhands/kinematics/ik_seeds.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"

namespace manyhands::internal {

namespace {

using T = NativeLanes;
constexpr std::size_t kW = static_cast<std::size_t>(width_v<T>);
constexpr double kEccentric = 0.8;

/// Of the frame, in the base of the chain.
Transform<T> placed(const Tree<float>& tree, const IkChain& chain, const T* q, Workspace<T>& ws) {
  const Transform<T> X_WF = place_chain(tree, chain, broadcast<float>(chain.X_BF), q, ws);
  if (!chain.base) return X_WF;
  return inverse(frame_pose(chain.base->body, broadcast<float>(chain.base->X_BF), ws)) * X_WF;
}

/// Of a joint's coordinate: its limits; where there is none, a whole turn or as many metres.
std::pair<float, float> range(float lower, float upper) {
  constexpr float kPi = std::numbers::pi_v<float>;
  if (is_finite(lower) && is_finite(upper)) return {lower, upper};
  if (is_finite(lower)) return {lower, lower + 2 * kPi};
  return is_finite(upper) ? std::pair{upper - 2 * kPi, upper} : std::pair{-kPi, kPi};
}

/// How far a pose is from a goal, squared: a radian counts as much as kRadian metres.
class Distance {
 public:
  Distance(const IkGoal& goal, const IkTarget<double>& target)
      : orientation_(goal.orientation),
        p_(broadcast<T>(broadcast<float>(target.X_WF.p))),
        toward_(broadcast<T>(broadcast<float>(target.toward))),
        axis_(broadcast<T>(broadcast<float>(goal.axis))) {
    const Quat<double> r = to_quat(target.X_WF.R);
    r_ = {constant<T>(r.x), constant<T>(r.y), constant<T>(r.z), constant<T>(r.w)};
  }

  [[nodiscard]] T operator()(const Vec3<T>& p, const Quat<T>& r) const {
    constexpr double kRadian = 0.5;
    const T one = constant<T>(1), off = squared_norm(p - p_);
    if (orientation_ == IkOrientation::kFree) return off;
    if (orientation_ == IkOrientation::kFull) {  // 1 - |cos(angle / 2)| is angle^2 / 8 and more
      const T cosine = fma(r.x, r_.x, fma(r.y, r_.y, fma(r.z, r_.z, r.w * r_.w)));
      return fma(constant<T>(8 * square(kRadian)), one - abs(cosine), off);
    }
    const Vec3<T> way = orientation_ == IkOrientation::kAxisAt ? toward_ - p_ : toward_;
    const T cosine = dot(to_matrix(r) * axis_, way) / max(norm(way), constant<T>(kNearestToLookAt));
    return fma(constant<T>(2 * square(kRadian)), one - cosine, off);
  }

 private:
  IkOrientation orientation_;
  Vec3<T> p_, toward_, axis_;
  Quat<T> r_{};
};

/// The first of the numbers that is the least of those above `beyond`.
template <std::size_t n>
std::size_t nearest(const std::array<T, n>& far, float beyond) {
  const T infinity = constant<T>(std::numeric_limits<double>::infinity());
  T least = infinity, at = constant<T>(0);
  for (std::size_t i = 0; i < n; ++i) {
    const auto less = (far[i] < least) & (far[i] > T(beyond));
    least = select(less, far[i], least);
    at = select(less, constant<T>(static_cast<double>(i)), at);
  }
  int best = 0;
  for (int k = 1; k < width_v<T>; ++k)
    if (lane(least, k) < lane(least, best)) best = k;
  return static_cast<std::size_t>(lane(at, best)) * kW + static_cast<std::size_t>(best);
}

}  // namespace

IkSeeds::IkSeeds(const Tree<float>& tree, const Params<float>& params, const IkChain& chain)
    : dofs_(chain.dofs.size()), q_(kSize * dofs_), numbers_(kSize * kNumbers) {
  for (const std::size_t dof : chain.dofs) {
    const auto moved =
        std::ranges::find(chain.bodies, static_cast<int>(dof), [&](std::size_t b) { return tree.bodies[b].iv; });
    const JointType type = tree.bodies[*moved].type;
    turns_freely_.push_back(!tree.dof_limited[dof] && (type == JointType::kRevolute || type == JointType::kContinuous));
  }
  place_all(tree, params, chain);
  std::vector<std::size_t> order(kSize);
  std::iota(order.begin(), order.end(), std::size_t{0});
  sort(order, 0);
  arrange(order);
}

void IkSeeds::place_all(const Tree<float>& tree, const Params<float>& params, const IkChain& chain) {
  Workspace<T> ws(tree);
  std::vector<T> q(index(tree.nq), constant<T>(0));  // zeros are what moves base and frame together at its neutral pose
  RandomStream random(0, 0, 0);
  for (std::size_t first = 0; first < kSize; first += kW) {
    for (std::size_t k = 0; k < dofs_; ++k) {
      const std::size_t dof = chain.dofs[k];
      const auto [low, high] = range(params.lower[dof], params.upper[dof]);
      for (std::size_t i = 0; i < kW; ++i) {
        float& x = q_[(first + i) * dofs_ + k];
        x = random.uniform(low, high);
        const float off = (x - 0.5f * (low + high)) / (0.5f * (high - low));
        numbers_[(kNumbers - 1) * kSize + first + i] += off * off / static_cast<float>(dofs_);
        set_lane(q[index(tree.dof_q[dof])], static_cast<int>(i), x);
      }
    }
    const Transform<T> X = placed(tree, chain, q.data(), ws);
    const Quat<T> r = to_quat(X.R);
    const std::array<T, kNumbers - 1> pose{X.p.x, X.p.y, X.p.z, r.x, r.y, r.z, r.w};
    for (std::size_t k = 0; k < pose.size(); ++k) store(&numbers_[k * kSize + first], pose[k]);
  }
}

/// By halves along x, y and z in turn.
void IkSeeds::sort(std::span<std::size_t> order, std::size_t node) {
  if (node >= split_.size()) return;
  std::size_t level = 0;
  for (std::size_t n = node + 1; n > 1; n /= 2) ++level;
  const float* along = &numbers_[level % 3 * kSize];
  const std::size_t half = order.size() / 2;
  std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [&](std::size_t i) { return along[i]; });
  split_[node] = along[order[half]];
  sort(order.first(half), 2 * node + 1);
  sort(order.subspan(half), 2 * node + 2);
}

void IkSeeds::arrange(std::span<const std::size_t> order) {
  const std::vector<float> q = q_, numbers = numbers_;
  for (std::size_t i = 0; i < kSize; ++i) {
    std::copy_n(&q[order[i] * dofs_], dofs_, &q_[i * dofs_]);
    for (std::size_t k = 0; k < kNumbers; ++k)
      numbers_[(i / kLeaf * kNumbers + k) * kLeaf + i % kLeaf] = numbers[k * kSize + order[i]];
  }
}

std::size_t IkSeeds::leaf_of(const Vec3<double>& p) const {
  const std::array<float, 3> at{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  std::size_t node = 0;
  for (std::size_t level = 0; level < kLevels; ++level) node = 2 * node + (at[level % 3] < split_[node] ? 1 : 2);
  return node - split_.size();
}

std::span<const float> IkSeeds::near(const IkGoal& goal, const IkTarget<double>& target, int rank) const {
  const Distance distance(goal, target);
  const std::size_t leaf = leaf_of(target.X_WF.p);
  const float* numbers = &numbers_[leaf * kLeaf * kNumbers];
  std::array<T, kLeaf / kW> far;
  for (std::size_t i = 0; i < far.size(); ++i) {
    const auto at = [&](std::size_t k) { return load<T>(numbers + k * kLeaf + i * kW); };
    const T off = distance({at(0), at(1), at(2)}, {at(3), at(4), at(5), at(6)});
    far[i] = fma(constant<T>(kEccentric), at(7), off);
  }
  std::size_t best = nearest(far, -1);
  for (; rank > 0; --rank) best = nearest(far, lane(far[best / kW], static_cast<int>(best % kW)));
  return std::span(q_).subspan((leaf * kLeaf + best) * dofs_, dofs_);
}

float IkSeeds::coordinate(std::span<const float> seed, std::size_t k, float here) const {
  constexpr float kTurn = 2 * std::numbers::pi_v<float>;
  return turns_freely_[k] != 0 ? fma(kTurn, round((here - seed[k]) / kTurn), seed[k]) : seed[k];
}

}  // namespace manyhands::internal
