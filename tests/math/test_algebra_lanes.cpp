// Every function of vec3.h, quaternion.h, spatial.h and rigid_motion.h: lane k holds the scalar's bits, on ordinary and
// hard inputs.
#include "manyhands/math/rigid_motion.h"
#include "tests/math/conformance.h"

namespace manyhands::testing {
namespace {

/// Hands out the inputs of one evaluation as vectors, quaternions and so on, and collects the outputs as numbers.
template <Number T>
class Tape {
 public:
  explicit Tape(const Numbers<T>& in) : in_(in) {}

  T number() { return in_.at(next_++); }
  Vec3<T> vec3() { return {number(), number(), number()}; }
  Quat<T> quat() { return {number(), number(), number(), number()}; }
  Mat3<T> mat3() { return {vec3(), vec3(), vec3()}; }
  Transform<T> transform() { return {mat3(), vec3()}; }
  Motion<T> motion() { return {vec3(), vec3()}; }
  Force<T> force() { return {vec3(), vec3()}; }
  SymMat3<T> symmetric() { return {number(), number(), number(), number(), number(), number()}; }
  RigidInertia<T> inertia() { return {number(), vec3(), symmetric()}; }

  void put(T a) { out_.push_back(a); }
  void put(const Vec3<T>& a) { put_all(a.x, a.y, a.z); }
  void put(const Quat<T>& a) { put_all(a.x, a.y, a.z, a.w); }
  void put(const Mat3<T>& a) { put_all(a.x, a.y, a.z); }
  void put(const Transform<T>& a) { put_all(a.R, a.p); }
  void put(const Motion<T>& a) { put_all(a.w, a.v); }
  void put(const Force<T>& a) { put_all(a.n, a.f); }
  void put(const SymMat3<T>& a) { put_all(a.xx, a.yy, a.zz, a.xy, a.xz, a.yz); }
  void put(const RigidInertia<T>& a) { put_all(a.m, a.h, a.I); }

  template <class... A>
  void put_all(const A&... a) {
    (put(a), ...);
  }

  Numbers<T> take() { return std::move(out_); }

 private:
  const Numbers<T>& in_;
  std::size_t next_ = 0;
  Numbers<T> out_;
};

// What is computed, at namespace scope so that all lane types share one scalar instantiation.

const auto vectors = []<class N>(Tape<N>& t) {
  Vec3<N> a = t.vec3();
  const Vec3<N> b = t.vec3();
  const N s = t.number(), u = t.number();
  t.put_all(a + b, a - b, -a, s * a, a * s, dot(a, b), cross(a, b), fma(s, a, b), squared_norm(a), norm(a),
            select(s < u, a, b), Vec3<N>::zero());
  a += b;
  t.put(a);
  a -= s * b;
  t.put(a);
};

const auto matrices_and_transforms = []<class N>(Tape<N>& t) {
  const Transform<N> a = t.transform(), b = t.transform();
  const Vec3<N> p = t.vec3();
  t.put_all(a.R * p, a.R * b.R, transpose_times(a.R, p), transpose(a.R), a * b, a * p, inverse(a), Mat3<N>::identity(),
            Transform<N>::identity());
};

const auto quaternions = []<class N>(Tape<N>& t) {
  const Quat<N> a = t.quat(), b = t.quat();
  const Vec3<N> r = t.vec3();
  const N time = t.number();
  const Mat3<N> m = t.mat3();
  t.put_all(a * b, normalized(a), to_matrix(a), to_quat(m), quat_from_rotation_vector(r), rotation_vector(a),
            integrate(a, r, time), rotation_from_rpy(r), Quat<N>::identity());
};

const auto spatial_vectors = []<class N>(Tape<N>& t) {
  const Motion<N> a = t.motion(), b = t.motion();
  const Force<N> f = t.force(), g = t.force();
  const N s = t.number();
  t.put_all(a + b, a - b, s * a, f + g, f - g, s * f, fma(s, a, b), fma(s, f, g), dot(a, f), cross(a, b), cross(a, f),
            Motion<N>::zero(), Force<N>::zero());
};

const auto rigid_motions = []<class N>(Tape<N>& t) {
  const Motion<N> m = t.motion();
  const Transform<N> X = t.transform();
  t.put_all(transformed(X, m), exp6(m), log6(X));
};

const auto inertias = []<class N>(Tape<N>& t) {
  const RigidInertia<N> a = t.inertia(), b = t.inertia();
  const Transform<N> X = t.transform();
  const Motion<N> V = t.motion();
  t.put_all(a + b, a * V, transformed(X, a), rotated(X.R, a.I), a.I * V.w, a.I + b.I, SymMat3<N>::zero(),
            RigidInertia<N>::zero());
};

template <class T>
class LaneAlgebra : public ::testing::Test {
 protected:
  /// `body(tape)` is the same generic code for lanes and scalars.
  template <class Body>
  void check(std::size_t arity, Body body) {
    const auto run = [&]<Number N>(const Numbers<N>& in) {
      Tape<N> tape(in);
      body(tape);
      return tape.take();
    };
    const auto lanes = [&](const Numbers<T>& in) { return run(in); };
    const auto scalar = [&](const Numbers<float>& in) { return run(in); };
    expect_lanes<T>(3000, arity, HardNumbers<float>(), lanes, scalar);
    expect_lanes<T>(3000, arity, Uniform<float>(-3, 3), lanes, scalar);
  }
};
TYPED_TEST_SUITE(LaneAlgebra, LaneTypes);

TYPED_TEST(LaneAlgebra, Vectors) { this->check(8, vectors); }

TYPED_TEST(LaneAlgebra, MatricesAndTransforms) { this->check(27, matrices_and_transforms); }

TYPED_TEST(LaneAlgebra, Quaternions) { this->check(21, quaternions); }

TYPED_TEST(LaneAlgebra, SpatialVectors) { this->check(25, spatial_vectors); }

TYPED_TEST(LaneAlgebra, RigidMotions) { this->check(18, rigid_motions); }

TYPED_TEST(LaneAlgebra, Inertias) { this->check(38, inertias); }

// A scalar of the model, in double, is the same rounded number in every lane.
TYPED_TEST(LaneAlgebra, BroadcastFillsEveryLane) {
  using T = TypeParam;
  Uniform<double> draw(-3, 3);
  Numbers<double> in(22);
  for (double& x : in) x = draw();
  Tape<double> model(in);
  const Transform<double> X = model.transform();
  const RigidInertia<double> a = model.inertia();
  const Numbers<T> none;
  Tape<T> lanes(none);
  lanes.put_all(broadcast<T>(X), broadcast<T>(a));
  const Numbers<T> out = lanes.take();
  ASSERT_EQ(out.size(), in.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (int k = 0; k < width_v<T>; ++k) EXPECT_EQ(lane(out[i], k), static_cast<float>(in[i]));
  }
}

[[gnu::noinline]] Transform<double> to_float_and_back(const Transform<double>& X) {
  return broadcast<double>(broadcast<float>(X));
}

// GCC 12 folds the two conversions into none where it puts several numbers into one vector.
TEST(Broadcast, RoundsWhatGoesBackToDouble) {
  Uniform<double> draw(-3, 3);
  Numbers<double> in(12);
  for (double& x : in) x = draw();
  Tape<double> model(in);
  const Transform<double> Y = to_float_and_back(model.transform());
  const Numbers<double> none;
  Tape<double> back(none);
  back.put_all(Y);
  const Numbers<double> out = back.take();
  ASSERT_EQ(out.size(), in.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const volatile float rounded = static_cast<float>(in[i]);
    EXPECT_EQ(out[i], static_cast<double>(rounded));
    EXPECT_NE(out[i], in[i]);
  }
}

}  // namespace
}  // namespace manyhands::testing
