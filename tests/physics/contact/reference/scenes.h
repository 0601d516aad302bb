// Contact problems made by hand: free bodies that touch, a grasp, and random ones.
#pragma once

#include <functional>
#include <random>
#include <string>

#include "tests/physics/contact/reference/problem.h"

namespace manyhands::testing {

inline constexpr double kStep = 0.002;    // [s]
inline constexpr double kGravity = 9.81;  // [m/s^2]

/// Builds a problem of free bodies, each with 6 dofs about its centre of mass (angular part first, world frame), and of
/// single joints. Body kWorld does not move.
class ProblemBuilder {
 public:
  static constexpr int kWorld = -1;

  /// A body with moments of inertia about its own axes [kg m^2], the columns of `R_WB`. Velocities before gravity.
  int add_body(double mass, const Eigen::Vector3d& inertia, const Eigen::Vector3d& p_WB,
               const Eigen::Matrix3d& R_WB = Eigen::Matrix3d::Identity(),
               const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero(),
               const Eigen::Vector3d& spin = Eigen::Vector3d::Zero()) {
    const int dof = add_dofs(6);
    const Eigen::Matrix3d I = R_WB * inertia.asDiagonal() * R_WB.transpose();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) mass_.emplace_back(dof + i, dof + j, I(i, j));
      mass_.emplace_back(dof + 3 + i, dof + 3 + i, mass);
      free_[static_cast<std::size_t>(dof + i)] = spin[i];
      free_[static_cast<std::size_t>(dof + 3 + i)] = velocity[i];
    }
    free_[static_cast<std::size_t>(dof + 5)] -= kStep * kGravity;
    const auto motion = [=](const Eigen::Vector3d& p_WC) {
      Eigen::Matrix<double, 3, Eigen::Dynamic> J(3, 6);
      const Eigen::Vector3d r = p_WC - p_WB;
      J << 0, r[2], -r[1], 1, 0, 0, -r[2], 0, r[0], 0, 1, 0, r[1], -r[0], 0, 0, 0, 1;
      return J;
    };
    movers_.push_back({dof, motion});
    return static_cast<int>(movers_.size()) - 1;
  }

  /// A part that moves with `dofs` coordinates: `motion` gives a point's velocity as a matrix (3, dofs).
  using Motion = std::function<Eigen::Matrix<double, 3, Eigen::Dynamic>(const Eigen::Vector3d& p_WC)>;
  int add_mechanism(const Eigen::MatrixXd& mass, const Eigen::VectorXd& free_velocity, Motion motion) {
    const int dof = add_dofs(static_cast<int>(mass.rows()));
    for (int i = 0; i < mass.rows(); ++i) {
      for (int j = 0; j < mass.cols(); ++j) mass_.emplace_back(dof + i, dof + j, mass(i, j));
      free_[static_cast<std::size_t>(dof + i)] = free_velocity[i];
    }
    movers_.push_back({dof, std::move(motion)});
    return static_cast<int>(movers_.size()) - 1;
  }

  /// A contact between parts A and B at p_WC, at distance `gap`; normal_AB points from A to B.
  void add_contact(int A, int B, const Eigen::Vector3d& p_WC, const Eigen::Vector3d& normal_AB, double mu,
                   double gap = 0) {
    const int row = 3 * static_cast<int>(mu_.size());
    Eigen::Matrix3d frame;  // rows n, t1, t2
    frame.row(0) = normal_AB.normalized();
    frame.row(1) = frame.row(0).unitOrthogonal();
    frame.row(2) = frame.row(0).cross(frame.row(1));
    for (const auto& [part, sign] : {std::pair(A, -1.0), std::pair(B, 1.0)}) {
      if (part == kWorld) continue;
      const Mover& mover = movers_[static_cast<std::size_t>(part)];
      const Eigen::MatrixXd J = sign * frame * mover.motion(p_WC);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < J.cols(); ++j) {
          if (J(i, j) != 0) jacobian_.emplace_back(row + i, mover.dof + j, J(i, j));
        }
      }
    }
    mu_.push_back(mu);
    b_.push_back(gap > 0 ? -gap / kStep : std::min(-0.2 * gap / kStep, 0.1));
  }

  /// The four corners of a rectangle with half sides `a` and `b` about `centre`, as contacts.
  void add_patch(int A, int B, const Eigen::Vector3d& centre, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                 double mu) {
    for (const double sa : {-1.0, 1.0}) {
      for (const double sb : {-1.0, 1.0}) add_contact(A, B, centre + sa * a + sb * b, a.cross(b), mu);
    }
  }

  [[nodiscard]] ReferenceProblem build() const {
    const auto nv = static_cast<Eigen::Index>(free_.size()), nc = static_cast<Eigen::Index>(mu_.size());
    SparseMatrix M(nv, nv);
    SparseRows J(3 * nc, nv);
    M.setFromTriplets(mass_.begin(), mass_.end());
    J.setFromTriplets(jacobian_.begin(), jacobian_.end());
    return {M, Eigen::Map<const Eigen::VectorXd>(free_.data(), nv), J,
            Eigen::Map<const Eigen::VectorXd>(mu_.data(), nc), Eigen::Map<const Eigen::VectorXd>(b_.data(), nc)};
  }

 private:
  struct Mover {
    int dof;
    Motion motion;
  };

  int add_dofs(int count) {
    const auto first = static_cast<int>(free_.size());
    free_.resize(free_.size() + static_cast<std::size_t>(count));
    return first;
  }

  std::vector<Mover> movers_;
  std::vector<Eigen::Triplet<double>> mass_, jacobian_;
  std::vector<double> free_, mu_, b_;
};

inline Eigen::Vector3d box_inertia(double mass, const Eigen::Vector3d& sides) {
  const Eigen::Vector3d s = sides.cwiseProduct(sides);
  return mass / 12 * Eigen::Vector3d(s[1] + s[2], s[0] + s[2], s[0] + s[1]);
}

/// A cube of 1 kg and 0.1 m on the ground: 4 contacts for 6 dofs.
inline ReferenceProblem box_on_ground(const Eigen::Vector3d& velocity, const Eigen::Vector3d& spin, double mu = 0.5) {
  ProblemBuilder scene;
  const Eigen::Vector3d sides = Eigen::Vector3d::Constant(0.1);
  const int box = scene.add_body(1, box_inertia(1, sides), {0, 0, 0.05}, Eigen::Matrix3d::Identity(), velocity, spin);
  scene.add_patch(ProblemBuilder::kWorld, box, {0, 0, 0}, {0.05, 0, 0}, {0, 0.05, 0}, mu);
  return scene.build();
}

/// Cubes of 4 cm on each other, the masses from the ground up.
inline ReferenceProblem tower(const std::vector<double>& masses, double mu = 0.6) {
  ProblemBuilder scene;
  int below = ProblemBuilder::kWorld;
  double z = 0;
  for (const double mass : masses) {
    const int cube = scene.add_body(mass, box_inertia(mass, Eigen::Vector3d::Constant(0.04)), {0, 0, z + 0.02});
    scene.add_patch(below, cube, {0, 0, z}, {0.02, 0, 0}, {0, 0.02, 0}, mu);
    below = cube;
    z += 0.04;
  }
  return scene.build();
}

/// A wall of `rows` courses of bricks (1 kg, 0.2 x 0.1 x 0.1 m) in bond, half bricks at the ends of every second one.
inline ReferenceProblem brick_wall(int rows, int columns, double mu = 0.6) {
  struct Brick {
    int body;
    double from, to;
  };
  ProblemBuilder scene;
  std::vector<Brick> below{{ProblemBuilder::kWorld, -1, 0.2 * columns + 1}};
  for (int row = 0; row < rows; ++row) {
    std::vector<Brick> course;
    const double z = 0.1 * row;
    // NOLINTNEXTLINE(bugprone-float-loop-counter): its bound leaves room for rounding
    for (double x = row % 2 == 0 ? 0 : -0.1; x < 0.2 * columns - 0.01; x += 0.2) {
      const double from = std::max(x, 0.0), to = std::min(x + 0.2, 0.2 * columns), length = to - from;
      const double mass = length / 0.2;
      const Eigen::Vector3d sides(length, 0.1, 0.1);
      const int body = scene.add_body(mass, box_inertia(mass, sides), {0.5 * (from + to), 0, z + 0.05});
      for (const Brick& other : below) {
        const double left = std::max(from, other.from), right = std::min(to, other.to);
        if (right - left < 0.01) continue;
        scene.add_patch(other.body, body, {0.5 * (left + right), 0, z}, {0.5 * (right - left), 0, 0}, {0, 0.05, 0}, mu);
      }
      course.push_back({body, from, to});
    }
    below = std::move(course);
  }
  return scene.build();
}

/// A dry half-circle arch: wedges between radii of 0.9 and 1.2 m, 0.3 m deep, both feet on the ground.
inline ReferenceProblem arch(int stones, double mu = 0.7) {
  ProblemBuilder scene;
  constexpr double kInner = 0.9, kOuter = 1.2, kDepth = 0.3, kDensity = 2000;
  const double wedge = M_PI / stones;
  const auto radial = [](double angle) { return Eigen::Vector3d(-std::cos(angle), 0, std::sin(angle)); };
  const Eigen::Vector3d y(0, 0.5 * kDepth, 0);
  int before = ProblemBuilder::kWorld;
  for (int i = 0; i <= stones; ++i) {
    int stone = ProblemBuilder::kWorld;
    if (i < stones) {
      const double area = 0.5 * wedge * (kOuter * kOuter - kInner * kInner), mass = kDensity * kDepth * area;
      const double centre = 2.0 / 3 * std::sin(wedge / 2) / (wedge / 2) * (std::pow(kOuter, 3) - std::pow(kInner, 3)) /
                            (kOuter * kOuter - kInner * kInner);
      const Eigen::Vector3d r = radial((i + 0.5) * wedge);
      Eigen::Matrix3d R;
      R << r, Eigen::Vector3d::UnitY(), r.cross(Eigen::Vector3d::UnitY());
      stone = scene.add_body(mass, box_inertia(mass, {kOuter - kInner, kDepth, wedge * centre}), centre * r, R);
    }
    const Eigen::Vector3d r = radial(i * wedge), along = 0.5 * (kOuter - kInner) * r;
    // The stones follow each other clockwise seen from -y: from left foot over the top to the right.
    scene.add_patch(before, stone, 0.5 * (kInner + kOuter) * r, y, along, mu);
    before = stone;
  }
  return scene.build();
}

/// n^3 spheres of 10 kg and 0.1 m radius in a grid, each moved by up to 0.2 mm; those nearer than 0.5 mm are contacts.
inline ReferenceProblem sphere_pile(int n, double mu = 0.5) {
  ProblemBuilder scene;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-0.0002, 0.0002), speed(-0.05, 0.05);
  std::vector<std::pair<int, Eigen::Vector3d>> spheres;
  for (int i = 0; i < n * n * n; ++i) {
    const int row = i / n % n, layer = i / (n * n);
    const Eigen::Vector3d grid(i % n, row, layer);
    const Eigen::Vector3d p = 0.2 * grid + Eigen::Vector3d(uniform(random), uniform(random), uniform(random) + 0.1);
    const Eigen::Vector3d v(speed(random), speed(random), speed(random));
    spheres.emplace_back(scene.add_body(10, Eigen::Vector3d::Constant(0.04), p, Eigen::Matrix3d::Identity(), v), p);
  }
  for (const auto& [b, p_B] : spheres) {
    if (p_B[2] < 0.1005) {
      scene.add_contact(ProblemBuilder::kWorld, b, {p_B[0], p_B[1], 0}, Eigen::Vector3d::UnitZ(), mu, p_B[2] - 0.1);
    }
    for (const auto& [a, p_A] : spheres) {
      if (a >= b) break;
      const Eigen::Vector3d d = p_B - p_A;
      if (d.norm() < 0.2005) scene.add_contact(a, b, 0.5 * (p_A + p_B), d, mu, d.norm() - 0.2);
    }
  }
  return scene.build();
}

/// A peg of 0.5 kg pressed down and askew between two walls: friction alone can hold it, in many ways.
inline ReferenceProblem peg_jam(double mu = 1.5) {
  ProblemBuilder scene;
  const Eigen::Vector3d sides(0.04, 0.04, 0.12);
  const int peg =
      scene.add_body(0.5, box_inertia(0.5, sides), {0, 0, 0}, Eigen::Matrix3d::Identity(), {0, 0, -0.3}, {0, 2.0, 0});
  for (const double y : {-0.02, 0.02}) {
    scene.add_contact(ProblemBuilder::kWorld, peg, {-0.02, y, -0.06}, Eigen::Vector3d::UnitX(), mu);
    scene.add_contact(ProblemBuilder::kWorld, peg, {-0.02, y, 0.02}, Eigen::Vector3d::UnitX(), mu);
    scene.add_contact(ProblemBuilder::kWorld, peg, {0.02, y, 0.06}, -Eigen::Vector3d::UnitX(), mu);
    scene.add_contact(ProblemBuilder::kWorld, peg, {0.02, y, -0.02}, -Eigen::Vector3d::UnitX(), mu);
  }
  return scene.build();
}

/// A cube of 1 kg between two pads of `finger_mass` that slide along x on a wrist of 0.1 kg (held by a stiff motor in z
/// and sliding freely in y), pressed together by saturated motors of `grip` newtons: 8 contacts.
inline ReferenceProblem slide_grasp(double finger_mass = 0.02, double grip = 20, double mu = 0.8) {
  ProblemBuilder scene;
  const double h = kStep;
  Eigen::Matrix4d M = Eigen::Vector4d(finger_mass, finger_mass, 0.1, 0.1).asDiagonal();  // left, right, wrist y, z
  M(2, 2) += 2 * finger_mass;
  M(3, 3) += 2 * finger_mass;
  const double stiff = 2000;  // [N s/m]: the motor's damping, implicit
  const double weight = M(3, 3) * kGravity;
  M(3, 3) += h * stiff;
  const Eigen::Vector4d v(h * grip / finger_mass, -h * grip / finger_mass, 0, -h * weight / M(3, 3));
  const int cube = scene.add_body(1, box_inertia(1, Eigen::Vector3d::Constant(0.05)), {0, 0, 0});
  const int hand = scene.add_mechanism(M, v, [](const Eigen::Vector3d& p) {
    Eigen::Matrix<double, 3, Eigen::Dynamic> J = Eigen::MatrixXd::Zero(3, 4);
    J(0, p[0] < 0 ? 0 : 1) = 1;
    J(1, 2) = J(2, 3) = 1;
    return J;
  });
  scene.add_patch(hand, cube, {-0.025, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}, mu);
  scene.add_patch(hand, cube, {0.025, 0, 0}, {0, 0, 0.01}, {0, 0.01, 0}, mu);
  return scene.build();
}

/// The same cube between two hinged fingers (links of 0.1 and 0.02 kg, saturated motors) on a wrist free to slide in y.
inline ReferenceProblem hinge_grasp(double torque = 1.2, double mu = 0.8) {
  ProblemBuilder scene;
  const double h = kStep;
  // Per finger: hinges along y at heights 0.10 and 0.05 m; point masses at 0.075 and 0.025 m.
  const auto motion = [](const Eigen::Vector3d& p) {
    Eigen::Matrix<double, 3, Eigen::Dynamic> J = Eigen::MatrixXd::Zero(3, 5);
    const int finger = p[0] < 0 ? 0 : 2;
    const double side = p[0] < 0 ? -1 : 1;
    const Eigen::Vector3d hinges[2] = {{side * 0.05, 0, 0.10}, {side * 0.03, 0, 0.05}};
    for (int k = 0; k < 2; ++k) {
      if (p[2] < hinges[k][2]) J.col(finger + k) = Eigen::Vector3d::UnitY().cross(p - hinges[k]);
    }
    J(1, 4) = 1;
    return J;
  };
  Eigen::MatrixXd M = 1e-6 * Eigen::MatrixXd::Identity(5, 5);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(5);
  M(4, 4) += 0.1;
  for (const double side : {-1.0, 1.0}) {
    for (const auto& [mass, z] : {std::pair(0.1, 0.075), std::pair(0.02, 0.025)}) {
      const Eigen::MatrixXd J = motion({side * 0.03, 0, z});
      M += mass * J.transpose() * J;
      force += J.transpose() * Eigen::Vector3d(0, 0, -mass * kGravity);
    }
    const int finger = side < 0 ? 0 : 2;
    force[finger] += side * torque;
    force[finger + 1] += side * 0.5 * torque;
  }
  const Eigen::VectorXd v = h * M.ldlt().solve(force);
  const int cube = scene.add_body(1, box_inertia(1, Eigen::Vector3d::Constant(0.05)), {0, 0, 0});
  const int hand = scene.add_mechanism(M, v, motion);
  scene.add_patch(hand, cube, {-0.025, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}, mu);
  scene.add_patch(hand, cube, {0.025, 0, 0}, {0, 0, 0.01}, {0, 0.01, 0}, mu);
  return scene.build();
}

/// A dense mass matrix with eigenvalues spread over `ratio`, and contacts with random rows, most of them closing.
inline ReferenceProblem random_problem(std::uint64_t seed, int nv, int contacts, double ratio, double mu) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto fill = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(fill(nv, nv)).householderQ();
  const Eigen::VectorXd eigenvalues =
      Eigen::VectorXd::NullaryExpr(nv, [&] { return std::pow(ratio, uniform(random) - 0.5); });
  const Eigen::MatrixXd M = Q * eigenvalues.asDiagonal() * Q.transpose(), J = fill(3 * contacts, nv);
  Eigen::VectorXd mus(contacts), b(contacts);
  for (int i = 0; i < contacts; ++i) {
    mus[i] = mu * (0.5 + uniform(random));
    b[i] = 0.1 * normal(random);
  }
  const Eigen::VectorXd v = fill(nv, 1);
  return {M.sparseView(), v, SparseRows(J.sparseView()), mus, b};
}

/// The problem as the next step might pose it: forces changed by `forces` of themselves, and targets as after a small
/// motion of the bodies, of `motion` times the problem's scale. Beside that, each contact may have opened by `uneven`
/// times the scale.
inline ReferenceProblem next_step(const ReferenceProblem& problem, double forces, double motion, double uneven,
                                  std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd v = problem.free_velocity, b = problem.b, push(3 * problem.contacts());
  for (double& x : v) x *= 1 + forces * uniform(random);
  for (int i = 0; i < problem.contacts(); ++i) {
    for (int k = 0; k < 3; ++k) push[3 * i + k] = uniform(random) * problem.scale / problem.size[i];
  }
  const Eigen::VectorXd moved = problem.J * (problem.response * push);
  for (int i = 0; i < problem.contacts(); ++i) {
    b[i] += motion * moved[3 * i] - uneven * problem.scale * std::abs(uniform(random));
  }
  return {problem.M, v, problem.J, problem.mu, b};
}

}  // namespace manyhands::testing
