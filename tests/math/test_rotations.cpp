// Rotations and transforms against their definitions: Rodrigues' series, orthonormality, group laws, half turns.
#include "manyhands/math/quaternion.h"
#include "tests/math/conformance.h"

namespace manyhands::testing {
namespace {

constexpr double kPi = std::numbers::pi;

template <Real R>
Mat3<R> skew(const Vec3<R>& a) {
  return {{R(0), a.z, -a.y}, {-a.z, R(0), a.x}, {a.y, -a.x, R(0)}};
}

template <Real R>
Mat3<R> plus(const Mat3<R>& a, R s, const Mat3<R>& b) {
  return {fma(s, b.x, a.x), fma(s, b.y, a.y), fma(s, b.z, a.z)};
}

/// The matrix exponential of [r]x by its power series, in double; of an eighth of r first, lest terms cancel.
Mat3<double> series_rotation(const Vec3<double>& r) {
  Mat3<double> sum = Mat3<double>::identity(), term = sum;
  for (int n = 1; n < 30; ++n) {
    term = skew(0.125 * r) * term;
    const double s = 1.0 / n;
    term = {s * term.x, s * term.y, s * term.z};
    sum = plus(sum, 1.0, term);
  }
  for (int doubling = 0; doubling < 3; ++doubling) sum = sum * sum;
  return sum;
}

template <Real R>
Vec3<double> wide(const Vec3<R>& a) {
  return broadcast<double>(a);
}

template <Real R>
double distance(const Vec3<R>& a, const Vec3<R>& b) {
  return norm(wide(a) - wide(b));
}
template <Real R, Real S>
double distance(const Mat3<R>& a, const Mat3<S>& b) {
  return norm(Vec3<double>{norm(wide(a.x) - wide(b.x)), norm(wide(a.y) - wide(b.y)), norm(wide(a.z) - wide(b.z))});
}

/// Of the rotations, not of the quaternions: q and -q are the same.
template <Real R>
double distance(const Quat<R>& a, const Quat<R>& b) {
  const double d = static_cast<double>(a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w);
  const double s = d < 0 ? -1 : 1;
  const auto square_gap = [&](R p, R q) { return square(static_cast<double>(p) - s * static_cast<double>(q)); };
  return std::sqrt(square_gap(a.x, b.x) + square_gap(a.y, b.y) + square_gap(a.z, b.z) + square_gap(a.w, b.w));
}

template <class R>
class Rotations : public ::testing::Test {
 protected:
  static constexpr double kTolerance = 16 * static_cast<double>(std::numeric_limits<R>::epsilon());

  Vec3<R> vector(double size) {
    const R s = static_cast<R>(size);
    return {s * draw_(), s * draw_(), s * draw_()};
  }
  Quat<R> rotation() { return normalized(Quat<R>{draw_(), draw_(), draw_(), draw_()}); }
  /// Directions along which selections change: axes, diagonals, and near them.
  static std::vector<Vec3<R>> directions() {
    std::vector<Vec3<R>> all;
    for (const double x : {-1.0, -1e-4, 0.0, 1.0}) {
      for (const double y : {-1.0, 0.0, 1e-7, 1.0}) {
        for (const double z : {-1.0, 0.0, 1e-3, 1.0}) {
          const Vec3<R> a{static_cast<R>(x), static_cast<R>(y), static_cast<R>(z)};
          if (norm(a) > R(0.5)) all.push_back((R(1) / norm(a)) * a);
        }
      }
    }
    return all;
  }

 private:
  Uniform<R> draw_{R(-1), R(1)};
};
TYPED_TEST_SUITE(Rotations, RealTypes);

TYPED_TEST(Rotations, ColumnsAreTheRotatedAxes) {
  using R = TypeParam;
  const R h = static_cast<R>(std::sqrt(0.5));
  const Mat3<R> m = to_matrix(Quat<R>{R(0), R(0), h, h});  // a quarter turn about z
  EXPECT_LT(distance(m.x, Vec3<R>{R(0), R(1), R(0)}), this->kTolerance);
  EXPECT_LT(distance(m.y, Vec3<R>{R(-1), R(0), R(0)}), this->kTolerance);
  EXPECT_LT(distance(m.z, Vec3<R>{R(0), R(0), R(1)}), this->kTolerance);
}

TYPED_TEST(Rotations, MatricesAreOrthonormalAndRightHanded) {
  using R = TypeParam;
  for (int i = 0; i < 1000; ++i) {
    const Mat3<R> m = to_matrix(this->rotation());
    EXPECT_LT(distance(transpose(m) * m, Mat3<R>::identity()), this->kTolerance);
    EXPECT_LT(distance(cross(m.x, m.y), m.z), this->kTolerance);
    const Vec3<R> a = this->vector(2);
    EXPECT_LT(distance(transpose_times(m, m * a), a), 4 * this->kTolerance);
  }
}

TYPED_TEST(Rotations, ProductsOfQuaternionsAreProductsOfMatrices) {
  using R = TypeParam;
  for (int i = 0; i < 1000; ++i) {
    const Quat<R> a = this->rotation(), b = this->rotation();
    EXPECT_LT(distance(to_matrix(a * b), to_matrix(a) * to_matrix(b)), this->kTolerance);
    EXPECT_LT(distance(a * Quat<R>::identity(), a), this->kTolerance);
  }
}

TYPED_TEST(Rotations, ExponentialIsThePowerSeries) {
  using R = TypeParam;
  for (const double size : {0.0, 1e-9, 1e-5, 5e-5, 1.1e-4, 1e-2, 1.0, 2.0, 5.0}) {
    for (int i = 0; i < 100; ++i) {
      const Vec3<R> r = this->vector(size);
      const Mat3<double> want = series_rotation(wide(r));
      EXPECT_LT(distance(to_matrix(quat_from_rotation_vector(r)), want), this->kTolerance) << size;
    }
  }
}

TYPED_TEST(Rotations, LogarithmInvertsTheExponential) {
  using R = TypeParam;
  for (const double angle : {0.0, 1e-8, 1e-6, 3e-6, 1e-4, 1e-3, 0.1, 1.0, 3.0, 3.14}) {
    for (const Vec3<R>& axis : this->directions()) {
      const Vec3<R> r = static_cast<R>(angle) * axis;
      const Quat<R> q = quat_from_rotation_vector(r);
      const Quat<R> minus_q{-q.x, -q.y, -q.z, -q.w};
      EXPECT_LT(distance(rotation_vector(q), r), this->kTolerance * angle + 1e-30) << angle;
      EXPECT_LT(distance(rotation_vector(minus_q), r), this->kTolerance * angle + 1e-30) << angle;
    }
  }
}

TYPED_TEST(Rotations, MatrixToQuaternionAndBack) {
  using R = TypeParam;
  for (int i = 0; i < 1000; ++i) {
    const Quat<R> q = this->rotation();
    const Quat<R> back = to_quat(to_matrix(q));
    EXPECT_LT(distance(back, q), this->kTolerance);
    EXPECT_GE(back.w, R(0));
  }
}

// At half turns w vanishes, and another component must be the pivot.
TYPED_TEST(Rotations, HalfTurnsSurviveTheRoundTrip) {
  using R = TypeParam;
  for (const Vec3<R>& axis : this->directions()) {
    for (const double angle : {kPi, kPi - 1e-3, kPi + 1e-3, -kPi}) {
      const Quat<R> q = quat_from_rotation_vector(static_cast<R>(angle) * axis);
      const Quat<R> back = to_quat(to_matrix(q));
      EXPECT_LT(distance(back, q), this->kTolerance);
      const Vec3<R> r = rotation_vector(back);
      EXPECT_LT(norm(wide(r)), kPi + this->kTolerance);
      EXPECT_LT(distance(quat_from_rotation_vector(r), q), this->kTolerance);
    }
    const Quat<R> exact{axis.x, axis.y, axis.z, R(0)};
    EXPECT_LT(distance(to_quat(to_matrix(exact)), exact), this->kTolerance);
    EXPECT_NEAR(static_cast<double>(norm(rotation_vector(exact))), kPi, this->kTolerance);
  }
}

TYPED_TEST(Rotations, IntegrationTurnsAboutTheFixedAxis) {
  using R = TypeParam;
  for (int i = 0; i < 200; ++i) {
    const Quat<R> q = this->rotation();
    const Vec3<R> omega = this->vector(3);
    const Mat3<double> turn = series_rotation(0.25 * wide(omega));
    const Mat3<R> m = to_matrix(q);
    const Mat3<double> start = broadcast<double>(m);
    EXPECT_LT(distance(to_matrix(integrate(q, omega, R(0.25))), turn * start), this->kTolerance);
  }
}

TYPED_TEST(Rotations, RollPitchYawTurnAboutTheFixedAxesInTurn) {
  using R = TypeParam;
  for (int i = 0; i < 200; ++i) {
    const Vec3<R> rpy = this->vector(4);
    const Vec3<double> angles = wide(rpy);
    const Mat3<double> want =
        series_rotation({0, 0, angles.z}) * series_rotation({0, angles.y, 0}) * series_rotation({angles.x, 0, 0});
    EXPECT_LT(distance(rotation_from_rpy(rpy), want), this->kTolerance);
  }
}

TYPED_TEST(Rotations, TransformsCompose) {
  using R = TypeParam;
  for (int i = 0; i < 200; ++i) {
    const Transform<R> X_AB{to_matrix(this->rotation()), this->vector(2)};
    const Transform<R> X_BC{to_matrix(this->rotation()), this->vector(2)};
    const Vec3<R> p_C = this->vector(2);
    EXPECT_LT(distance((X_AB * X_BC) * p_C, X_AB * (X_BC * p_C)), 4 * this->kTolerance);
    const Transform<R> identity = inverse(X_AB) * X_AB;
    EXPECT_LT(distance(identity.R, Mat3<R>::identity()), this->kTolerance);
    EXPECT_LT(distance(identity.p, Vec3<R>::zero()), 4 * this->kTolerance);
    EXPECT_LT(distance(inverse(X_AB) * (X_AB * p_C), p_C), 4 * this->kTolerance);
  }
}

}  // namespace
}  // namespace manyhands::testing
