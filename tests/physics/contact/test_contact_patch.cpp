// A patch responds as its points' own rows do: what an impulse at one point does to the velocity at another.
#include <gtest/gtest.h>

#include <random>

#include "manyhands/physics/contact/contact_patch.h"

namespace manyhands {
namespace {

constexpr int kDofs = 9;
constexpr double kRounding = 1e-12;

using Vec = Vec3<double>;

/// Six rows of numbers in the coordinates y, and the patch that has them.
struct Rows {
  explicit Rows(unsigned seed) : rng(seed) {
    for (int k = 0; k < kDofs; ++k) {
      linear.push_back(any());
      angular.push_back(any());
    }
    patch.turns = true;
    patch.friction_1 = 0.7;
    patch.friction_2 = 0.4;
    response.G_vf = product(linear, linear);
    response.G_wf = product(angular, linear);
    response.G_wn = product(angular, angular);
  }
  Vec any() {
    std::normal_distribution<double> normal;
    return {normal(rng), normal(rng), normal(rng)};
  }
  /// a b^T by its columns.
  static Mat3<double> product(const std::vector<Vec>& a, const std::vector<Vec>& b) {
    Mat3<double> sum{Vec::zero(), Vec::zero(), Vec::zero()};
    for (int k = 0; k < kDofs; ++k) {
      sum.x += b[k].x * a[k];
      sum.y += b[k].y * a[k];
      sum.z += b[k].z * a[k];
    }
    return sum;
  }
  /// The rows of a point: along the normal and the tangents scaled by friction, v + w x lever.
  std::vector<Vec> at(const Vec& lever) const {
    std::vector<Vec> rows;
    for (int k = 0; k < kDofs; ++k) {
      const Vec u = linear[k] + cross(angular[k], lever);
      rows.push_back({u.x, linear[k].y + 0.7 * (u.y - linear[k].y), linear[k].z + 0.4 * (u.z - linear[k].z)});
    }
    return rows;
  }

  std::mt19937 rng;
  std::vector<Vec> linear, angular;
  ContactPatch<double> patch;
  PatchResponse<double> response;
};

void expect_near(const Vec& a, const Vec& b) { EXPECT_LT(norm(a - b), kRounding * (1 + norm(b))); }

TEST(ContactPatch, APointRespondsAsItsRows) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Rows rows(seed);
    const Vec lever = rows.any();
    const Mat3<double> G = point_response(rows.patch, rows.response, lever),
                       truth = Rows::product(rows.at(lever), rows.at(lever));
    expect_near(G.x, truth.x);
    expect_near(G.y, truth.y);
    expect_near(G.z, truth.z);
  }
}

TEST(ContactPatch, AnImpulseAtOnePointMovesAnotherAsTheirRowsSay) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Rows rows(seed);
    const Vec here = rows.any(), there = rows.any(), impulse = rows.any();
    const Motion<double> motion = respond(rows.patch, rows.response, force_at(rows.patch, here, impulse));
    expect_near(velocity_at(rows.patch, there, motion), Rows::product(rows.at(there), rows.at(here)) * impulse);
  }
}

}  // namespace
}  // namespace manyhands
