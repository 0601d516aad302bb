// Spatial algebra against clouds of point masses and against matrices written out.
#include "manyhands/math/quaternion.h"
#include "manyhands/math/spatial.h"
#include "tests/math/conformance.h"

namespace manyhands::testing {
namespace {

template <class R>
class Spatial : public ::testing::Test {
 protected:
  struct Particle {
    R mass;
    Vec3<R> p;
  };

  static constexpr R kTolerance = 200 * std::numeric_limits<R>::epsilon();

  Vec3<R> vector() { return {draw_(), draw_(), draw_()}; }
  Motion<R> motion() { return {vector(), vector()}; }
  Force<R> force() { return {vector(), vector()}; }
  Mat3<R> rotation() { return to_matrix(normalized(Quat<R>{draw_(), draw_(), draw_(), draw_()})); }
  std::vector<Particle> cloud() {
    std::vector<Particle> particles(8);
    for (Particle& particle : particles) particle = {R(0.1) + abs(draw_()), vector()};
    return particles;
  }

  /// By definition: sum m, sum m p, sum m (p.p 1 - p p^T).
  static RigidInertia<R> inertia_of(const std::vector<Particle>& particles) {
    RigidInertia<R> sum = RigidInertia<R>::zero();
    for (const auto& [m, p] : particles) {
      sum.m += m;
      sum.h += m * p;
      sum.I.xx += m * (p.y * p.y + p.z * p.z);
      sum.I.yy += m * (p.x * p.x + p.z * p.z);
      sum.I.zz += m * (p.x * p.x + p.y * p.y);
      sum.I.xy -= m * p.x * p.y;
      sum.I.xz -= m * p.x * p.z;
      sum.I.yz -= m * p.y * p.z;
    }
    return sum;
  }

  static void expect_near(const Vec3<R>& a, const Vec3<R>& b) {
    EXPECT_NEAR(a.x, b.x, kTolerance);
    EXPECT_NEAR(a.y, b.y, kTolerance);
    EXPECT_NEAR(a.z, b.z, kTolerance);
  }
  static void expect_near(const SymMat3<R>& a, const SymMat3<R>& b) {
    expect_near(Vec3<R>{a.xx, a.yy, a.zz}, Vec3<R>{b.xx, b.yy, b.zz});
    expect_near(Vec3<R>{a.xy, a.xz, a.yz}, Vec3<R>{b.xy, b.xz, b.yz});
  }

 private:
  Uniform<R> draw_{R(-1), R(1)};
};
TYPED_TEST_SUITE(Spatial, RealTypes);

TYPED_TEST(Spatial, TransformedInertiaIsThatOfTheMovedParticles) {
  using R = TypeParam;
  for (int i = 0; i < 200; ++i) {
    auto particles = this->cloud();
    const Transform<R> X_OB{this->rotation(), this->vector()};
    const RigidInertia<R> got = transformed(X_OB, this->inertia_of(particles));
    for (auto& particle : particles) particle.p = X_OB * particle.p;
    const RigidInertia<R> want = this->inertia_of(particles);
    EXPECT_NEAR(got.m, want.m, this->kTolerance);
    this->expect_near(got.h, want.h);
    this->expect_near(got.I, want.I);
  }
}

TYPED_TEST(Spatial, InertiasOfPartsAddUp) {
  auto particles = this->cloud();
  const auto other = this->cloud();
  const auto sum = this->inertia_of(particles) + this->inertia_of(other);
  particles.insert(particles.end(), other.begin(), other.end());
  const auto want = this->inertia_of(particles);
  EXPECT_NEAR(sum.m, want.m, this->kTolerance);
  this->expect_near(sum.h, want.h);
  this->expect_near(sum.I, want.I);
}

TYPED_TEST(Spatial, MomentumAndEnergyAreThoseOfTheParticles) {
  using R = TypeParam;
  for (int i = 0; i < 200; ++i) {
    const auto particles = this->cloud();
    const Motion<R> V = this->motion();
    Force<R> momentum = Force<R>::zero();
    R twice_energy = 0;
    for (const auto& [m, p] : particles) {
      const Vec3<R> velocity = V.v + cross(V.w, p);
      momentum = momentum + Force<R>{m * cross(p, velocity), m * velocity};
      twice_energy += m * squared_norm(velocity);
    }
    const Force<R> got = this->inertia_of(particles) * V;
    this->expect_near(got.n, momentum.n);
    this->expect_near(got.f, momentum.f);
    EXPECT_NEAR(dot(V, got), twice_energy, this->kTolerance);
  }
}

TYPED_TEST(Spatial, RotatedIsTheCongruence) {
  using R = TypeParam;
  for (int i = 0; i < 200; ++i) {
    const SymMat3<R> m = this->inertia_of(this->cloud()).I;
    const Mat3<R> rotation = this->rotation();
    const Mat3<R> full{{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
    const Mat3<R> want = rotation * full * transpose(rotation);
    this->expect_near(rotated(rotation, m), {want.x.x, want.y.y, want.z.z, want.y.x, want.z.x, want.z.y});
    const Vec3<R> a = this->vector();
    this->expect_near(m * a, full * a);
  }
}

// crm and crf of Featherstone (2008, equations 2.31 and 2.32), row by row.
TYPED_TEST(Spatial, CrossProductsAreThoseOfTheBook) {
  using R = TypeParam;
  const Motion<R> a = this->motion(), b = this->motion();
  const Force<R> f = this->force();
  const auto by_hand = [](const Vec3<R>& p, const Vec3<R>& q) {
    return Vec3<R>{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
  };
  this->expect_near(cross(a, b).w, by_hand(a.w, b.w));
  this->expect_near(cross(a, b).v, by_hand(a.v, b.w) + by_hand(a.w, b.v));
  this->expect_near(cross(a, f).n, by_hand(a.w, f.n) + by_hand(a.v, f.f));
  this->expect_near(cross(a, f).f, by_hand(a.w, f.f));
}

// d/dt (b . f) = (a x b) . f + b . (a x* f) = 0: carried along together, b and f keep their power.
TYPED_TEST(Spatial, CrossProductsAreDual) {
  using R = TypeParam;
  for (int i = 0; i < 200; ++i) {
    const Motion<R> a = this->motion(), b = this->motion();
    const Force<R> f = this->force();
    EXPECT_NEAR(dot(cross(a, b), f), -dot(b, cross(a, f)), this->kTolerance);
  }
}

TYPED_TEST(Spatial, MotionsObeyJacobisIdentity) {
  using R = TypeParam;
  const Motion<R> a = this->motion(), b = this->motion(), c = this->motion();
  const Motion<R> sum = cross(a, cross(b, c)) + cross(b, cross(c, a)) + cross(c, cross(a, b));
  this->expect_near(sum.w, Vec3<R>::zero());
  this->expect_near(sum.v, Vec3<R>::zero());
}

TYPED_TEST(Spatial, PowerDoesNotDependOnThePointOfReference) {
  using R = TypeParam;
  const Vec3<R> force = this->vector(), at = this->vector();
  const Motion<R> V = this->motion();
  EXPECT_NEAR(dot(V, Force<R>{cross(at, force), force}), dot(force, V.v + cross(V.w, at)), this->kTolerance);
}

}  // namespace
}  // namespace manyhands::testing
