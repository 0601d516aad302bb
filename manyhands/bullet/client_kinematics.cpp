// Client: kinematics and dynamics of one body, at positions that are given.
#include <algorithm>
#include <cmath>

#include "manyhands/bullet/client_body.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/dynamics/crba.h"
#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/physics/dynamics/ltdl.h"
#include "manyhands/physics/dynamics/rnea.h"

namespace manyhands::bullet {

Mechanism& Client::mechanism_of(Body& body) {
  if (body.mechanism) return *body.mechanism;
  BodyPlan plan = body.plan;  // whose base is its inertial frame
  for (LinkPlan& link : plan.links) {
    if (link.parent < 0) link.X_PJ = inverse(plan.base.X_LI) * link.X_PJ;
  }
  plan.base.X_LI = Transform<double>::identity();
  body.mechanism = std::make_unique<Mechanism>(model_of(plan, Transform<double>::identity()));
  Mechanism& m = *body.mechanism;
  for (const LinkPlan& link : body.plan.links) {
    if (velocity_size(link.joint) == 0) continue;
    const Joint& joint = m.model.joint(m.model.joint_id(link.joint_name));
    for (int k = 0; k < configuration_size(link.joint); ++k) m.iq.push_back(joint.iq + k);
    for (int k = 0; k < velocity_size(link.joint); ++k) m.iv.push_back(joint.iv + k);
  }
  return m;
}

namespace {

using Numbers = std::vector<double>;

/// PyBullet's positions of the joints that move, in the model's order, behind a base at the origin or as `q` has it.
Numbers configuration(const Mechanism& m, std::span<const double> q) {
  Numbers all = m.model.neutral_configuration();
  const std::size_t base = q.size() - m.iq.size();
  if (base > 0) std::copy_n(q.begin(), base, all.begin());
  for (std::size_t i = 0; i < m.iq.size(); ++i) all[static_cast<std::size_t>(m.iq[i])] = q[base + i];
  return all;
}

/// Columns of PyBullet's matrices: the base's six, if it is free, then the joints'.
std::vector<int> columns(const Mechanism& m, bool free) {
  std::vector<int> all;
  for (int k = 0; free && k < 6; ++k) all.push_back(k);
  all.insert(all.end(), m.iv.begin(), m.iv.end());
  return all;
}

/// Places of the numbers of velocities and forces where each spherical joint has a fourth one, as has the free base,
/// which comes first and linear before angular; -1 at those that stand for nothing.
std::vector<int> padded_columns(const Mechanism& m, const BodyPlan& plan) {
  std::vector<int> all;
  if (!plan.fixed) all = {3, 4, 5, 0, 1, 2, -1};
  std::size_t next = 0;
  for (const LinkPlan& link : plan.links) {
    for (int k = 0; k < velocity_size(link.joint); ++k) all.push_back(m.iv[next++]);
    if (link.joint == JointType::kSpherical) all.push_back(-1);
  }
  return all;
}

/// What stands in those places.
Numbers unpadded(const Mechanism& m, std::span<const int> places, std::span<const double> numbers) {
  Numbers all(static_cast<std::size_t>(m.model.nv()), 0.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] >= 0) all[static_cast<std::size_t>(places[i])] = numbers[i];
  }
  return all;
}

void require_length(const char* what, std::span<const double> numbers, std::size_t n) {
  if (numbers.size() == n) return;
  throw Error(std::string(what) + " has " + std::to_string(numbers.size()) + " numbers; expected " + std::to_string(n) +
              ", one for each joint that moves");
}

/// Solves A x = b in place for a symmetric positive definite A, given by its lower triangle, as L D L^T.
template <std::size_t n>
void solve(std::array<double, n * n>& A, std::array<double, n>& b) {
  std::array<double, n> D{}, inverse{};
  for (std::size_t j = 0; j < n; ++j) {
    std::array<double, n> scaled{};  // L D of row j
    double d = A[j * n + j];
    for (std::size_t k = 0; k < j; ++k) {
      scaled[k] = A[j * n + k] * D[k];
      d -= A[j * n + k] * scaled[k];
    }
    D[j] = std::max(d, 1e-300);
    inverse[j] = 1 / D[j];
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) A[i * n + j] -= A[i * n + k] * scaled[k];
      A[i * n + j] *= inverse[j];
    }
    for (std::size_t k = 0; k < j; ++k) b[j] -= A[j * n + k] * b[k];
  }
  for (std::size_t i = n; i-- > 0;) {
    b[i] *= inverse[i];
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= A[k * n + i] * b[k];
  }
}

/// PyBullet's damped least squares, one problem's numbers.
template <std::size_t kRows>
class Search {
 public:
  Search(Mechanism& m, LinkId link, const LinkPlan& plan, const IkRequest& request, const Transform<double>& goal)
      : m_(m), link_(m.model.link(link)), plan_(plan), request_(request), goal_(goal), n_(m.iq.size()) {
    J_.reserve(n_);
    step_.resize(n_);
    softness_.resize(n_, 1 / kDamping);
    for (std::size_t i = 0; i < n_ && request.damping.size() >= n_; ++i) {
      softness_[i] = 1 / std::max(request.damping[i], kLeastDamping);
    }
    for (BodyId b = link_.body; b.value() > 0; b = m_.model.body(b).parent) path_.push_back(b.index());
    std::ranges::reverse(path_);
    joint_of_.assign(static_cast<std::size_t>(m.model.nv()), -1);
    for (std::size_t i = 0; i < n_; ++i) joint_of_[static_cast<std::size_t>(m.iv[i])] = static_cast<int>(i);
  }

  Numbers run(Numbers q) {
    Numbers all = configuration(m_, q);
    for (int k = 0; k < request_.max_iterations; ++k) {
      for (const std::size_t b : path_) place(m_.tree, b, all.data(), m_.ws);
      const bool is_last = set_error() <= request_.threshold;  // as in PyBullet, one step more
      set_jacobian();
      if (uses_null_space()) {
        step_in_null_space(q);
      } else {
        step_damped();
      }
      double most = 0;
      for (const double x : step_) most = std::max(most, std::abs(x));
      const double share = most > kLargestStep ? kLargestStep / most : 1;
      for (std::size_t i = 0; i < n_; ++i) {
        q[i] += share * step_[i];
        all[static_cast<std::size_t>(m_.iq[i])] = q[i];
      }
      if (is_last) break;
    }
    return q;
  }

 private:
  struct Column {
    std::size_t joint{};
    std::array<double, kRows> rows{};
  };

  static constexpr double kLargestStep = 0.7853981633974483;  // of a joint in one iteration [rad]
  static constexpr double kDamping = 0.5, kLeastDamping = 1e-9;

  /// Returns how far the position is off [m].
  double set_error() {
    const Transform<double> X = frame_pose(link_.body, link_.X_BL, m_.ws);
    const Vec3<double> p = goal_.p - X.p;
    e_[0] = p.x;
    e_[1] = p.y;
    e_[2] = p.z;
    if constexpr (kRows == 6) {
      const Vec3<double> r = rotation_vector(to_quat(goal_.R * transpose(X.R * plan_.X_LI.R)));
      e_[3] = r.x;
      e_[4] = r.y;
      e_[5] = r.z;
    }
    return norm(p);
  }

  void set_jacobian() {
    J_.clear();
    visit_jacobian(m_.tree, link_.body, link_.X_BL.p, m_.ws, [&](int dof, const Motion<double>& S) {
      const int i = joint_of_[static_cast<std::size_t>(dof)];
      if (i < 0) return;
      Column& column = J_.emplace_back();
      column.joint = static_cast<std::size_t>(i);
      // Number by number: an array copied as a whole would wait until each of them is written.
      column.rows[0] = S.v.x;
      column.rows[1] = S.v.y;
      column.rows[2] = S.v.z;
      if constexpr (kRows == 6) {
        column.rows[3] = S.w.x;
        column.rows[4] = S.w.y;
        column.rows[5] = S.w.z;
      }
    });
  }

  /// (J W J^T + c I)^-1 x, with a weight of each joint.
  template <class Weight>
  [[nodiscard]] std::array<double, kRows> solved(std::array<double, kRows> x, double c, Weight&& weight) const {
    std::array<double, kRows * kRows> A{};
    for (std::size_t r = 0; r < kRows; ++r) A[r * kRows + r] = c;
    for (const Column& column : J_) {
      const double w = weight(column.joint);
      for (std::size_t r = 0; r < kRows; ++r) {
        const double scaled = w * column.rows[r];
        for (std::size_t s = 0; s <= r; ++s) A[r * kRows + s] += scaled * column.rows[s];
      }
    }
    solve<kRows>(A, x);
    return x;
  }

  [[nodiscard]] static double product(const Column& column, const std::array<double, kRows>& x) {
    double sum = 0;
    for (std::size_t r = 0; r < kRows; ++r) sum += column.rows[r] * x[r];
    return sum;
  }

  /// dq = (J^T J + D)^-1 J^T e = D^-1 J^T (J D^-1 J^T + 1)^-1 e, with D the damping of each joint.
  void step_damped() {
    const std::array<double, kRows> y = solved(e_, 1, [&](std::size_t i) { return softness_[i]; });
    std::ranges::fill(step_, 0.0);
    for (const Column& column : J_) step_[column.joint] = softness_[column.joint] * product(column, y);
  }

  [[nodiscard]] bool uses_null_space() const {
    return request_.lower.size() == n_ && request_.upper.size() == n_ && request_.range.size() == n_ &&
           request_.rest.size() == n_;
  }

  /// dq = J^+ e + (1 - J^+ J) v with J^+ = J^T (J J^T + 0.36)^-1, and v towards the rest pose and into the limits.
  void step_in_null_space(const Numbers& q) {
    constexpr double kNullDamping = 0.36, kRestGain = 0.001, kLimitGain = 10;
    Numbers& v = step_;
    for (std::size_t i = 0; i < n_; ++i) {
      v[i] = kRestGain * (request_.rest[i] - q[i]);
      if (q[i] > request_.upper[i]) v[i] += kLimitGain * (request_.upper[i] - q[i]) / request_.range[i];
      if (q[i] < request_.lower[i]) v[i] += kLimitGain * (request_.lower[i] - q[i]) / request_.range[i];
    }
    std::array<double, kRows> left = e_;  // e - J v
    for (const Column& column : J_) {
      for (std::size_t r = 0; r < kRows; ++r) left[r] -= column.rows[r] * v[column.joint];
    }
    const std::array<double, kRows> y = solved(left, kNullDamping, [](std::size_t) { return 1.0; });
    for (const Column& column : J_) v[column.joint] += product(column, y);
  }

  Mechanism& m_;
  const Link& link_;
  const LinkPlan& plan_;
  const IkRequest& request_;
  const Transform<double>& goal_;
  std::size_t n_;
  std::array<double, kRows> e_{};
  std::vector<Column> J_;  // of the joints that move the link
  Numbers step_, softness_;
  std::vector<std::size_t> path_;  // bodies from the base to the link
  std::vector<int> joint_of_;      // (nv), or -1
};

}  // namespace

std::vector<double> Client::inverse_kinematics(int id, const IkRequest& request) {
  constexpr const char* kError = "Error in calculateInverseKinematics";
  Body& body = at(id, kError);
  if (!body.has_joint(request.link)) throw Error(kError);
  Mechanism& m = mechanism_of(body);
  const std::size_t n = m.iq.size();
  if (static_cast<int>(n) != body.num_dofs)
    throw Error("calculateInverseKinematics knows no spherical or planar joints");
  const bool in_base = !request.start.empty();
  Numbers q = request.start;
  if (in_base) {
    require_length("currentPositions", q, n);
  } else {
    for (int i = 0; i < body.plan.num_links(); ++i) {
      if (body.dof[static_cast<std::size_t>(i)] >= 0) q.push_back(world_.joint_q(joint_id(body, i))[0]);
    }
  }
  Transform<double> goal{Mat3<double>::identity(), request.position};
  if (request.orientation) goal.R = to_matrix(normalized(*request.orientation));
  if (!in_base) goal = inverse(inertial_pose(body, -1)) * goal;
  const LinkId link = m.model.link_id(model_name(body.plan.link(request.link)));
  const LinkPlan& plan = body.plan.link(request.link);
  if (request.orientation) return Search<6>(m, link, plan, request, goal).run(std::move(q));
  return Search<3>(m, link, plan, request, goal).run(std::move(q));
}

std::vector<double> Client::jacobian(int id, int link, const Vec3<double>& point, std::span<const double> q) {
  Body& body = at(id, "Error in calculateJacobian: there is no such body.");
  if (!body.has_link(link)) throw Error("Error in calculateJacobian: link index out-of-range.");
  Mechanism& m = mechanism_of(body);
  require_length("calculateJacobian: objPositions", q, m.iq.size());
  const Numbers all = configuration(m, q);
  forward_kinematics(m.tree, all.data(), m.ws);
  const Link& part = m.model.link(m.model.link_id(model_name(body.plan.link(link))));
  const Vec3<double> in_body = part.X_BL * (body.plan.link(link).X_LI.R * point);
  const bool free = !body.plan.fixed;
  const std::vector<int> dofs = columns(m, free);
  Numbers J(6 * dofs.size(), 0.0);
  visit_jacobian(m.tree, part.body, in_body, m.ws, [&](int dof, const Motion<double>& S) {
    const auto found = std::ranges::find(dofs, dof);
    if (found == dofs.end()) return;
    const std::array<double, 6> numbers{S.v.x, S.v.y, S.v.z, S.w.x, S.w.y, S.w.z};
    for (std::size_t r = 0; r < 6; ++r)
      J[r * dofs.size() + static_cast<std::size_t>(found - dofs.begin())] = numbers[r];
  });
  return J;
}

std::vector<double> Client::mass_matrix(int id, std::span<const double> q, bool padded) {
  Body& body = at(id, "Error in calculateMassMatrix: there is no such body.");
  Mechanism& m = mechanism_of(body);
  const std::size_t base = body.plan.fixed ? 0 : 7;
  if (!padded && base > 0 && q.size() == m.iq.size() + base) q = q.subspan(base);  // in the axes of the base, wherever
  require_length("calculateMassMatrix: objPositions", q, m.iq.size() + (padded ? base : 0));
  const Numbers all = configuration(m, q);
  crba(m.tree, m.params, all.data(), m.ws);
  const std::vector<int> dofs = padded ? padded_columns(m, body.plan) : columns(m, !body.plan.fixed);
  Numbers M;
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    for (std::size_t k = 0; k < dofs.size(); ++k) {
      const auto row = static_cast<std::size_t>(std::max(dofs[i], dofs[k]));
      const int column = std::min(dofs[i], dofs[k]);
      if (column < 0) {
        M.push_back(i == k ? 1.0 : 0.0);
        continue;
      }
      const bool meets = m.tree.root_dof[row] <= column;
      M.push_back(meets ? tree_row(m.tree, m.ws.M.data(), row)[static_cast<std::size_t>(column)] : 0.0);
    }
  }
  return M;
}

std::vector<double> Client::inverse_dynamics(int id, std::span<const double> q, std::span<const double> v,
                                             std::span<const double> a, bool padded) {
  constexpr const char* kError = "Error in calculateInverseDynamics, please check arguments.";
  Body& body = at(id, kError);
  Mechanism& m = mechanism_of(body);
  const std::vector<int> places = padded ? padded_columns(m, body.plan) : columns(m, !body.plan.fixed);
  const std::size_t base = body.plan.fixed ? 0 : 7;
  if (q.size() != m.iq.size() + base || v.size() != places.size() || a.size() != places.size()) throw Error(kError);
  m.params.gravity[0] = world_.gravity();
  const Numbers qs = configuration(m, q), vs = unpadded(m, places, v), as = unpadded(m, places, a);
  Numbers tau(static_cast<std::size_t>(m.model.nv())), result;
  rnea(m.tree, m.params, qs.data(), vs.data(), as.data(), tau.data(), m.ws);
  for (const int place : places) result.push_back(place < 0 ? 0.0 : tau[static_cast<std::size_t>(place)]);
  if (!padded && base > 0) std::swap_ranges(result.begin(), result.begin() + 3, result.begin() + 3);
  return result;
}

}  // namespace manyhands::bullet
