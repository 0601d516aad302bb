#include <gtest/gtest.h>

#include "manyhands/render/simplify.h"
#include "manyhands/render/triangles.h"
#include "tests/render/render_testing.h"

namespace manyhands {
namespace {

/// normal(p): at a vertex p.
template <class Normal>
std::vector<Facet> facets_of(const Mesh& mesh, Normal&& normal) {
  std::vector<Facet> facets;
  for (const auto& t : mesh.triangles) {
    Facet& facet = facets.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      facet.corner[k] = mesh.vertices[static_cast<std::size_t>(t[k])];
      facet.normal[k] = normal(facet.corner[k]);
    }
  }
  return facets;
}

TEST(Simplify, ACoarserBallIsClosedAndCloseToTheBall) {
  const auto outwards = [](const Vec3<float>& p) { return (1 / norm(p)) * p; };
  const std::vector<Facet> fine = facets_of(testing::ball_mesh(0.1, 40), outwards);
  ASSERT_TRUE(is_closed(fine));
  Simplifier simplifier(fine);
  std::size_t last = fine.size();
  for (const double error : {0.0005, 0.001, 0.002, 0.004}) {
    simplifier.simplify(error, 0.5);
    const std::vector<Facet> coarse = simplifier.facets();
    EXPECT_LT(coarse.size(), last);
    last = coarse.size();
    EXPECT_TRUE(is_closed(coarse));
    for (const Facet& facet : coarse) {
      const Vec3<float> middle = (1.0f / 3) * (facet.corner[0] + facet.corner[1] + facet.corner[2]);
      EXPECT_NEAR(static_cast<double>(norm(middle)), 0.1, 4 * error);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(norm(facet.corner[k]), 0.1f, 1e-6f);  // a vertex of the ball, with the ball's normal
        EXPECT_NEAR(dot(facet.normal[k], facet.corner[k]), 0.1f, 1e-6f);
      }
    }
  }
  EXPECT_LT(last, fine.size() / 10);
}

TEST(Simplify, FlatFacesKeepTheirEdgesAndRims) {
  // A square of 20 x 20 cells, open: it can be four corners, and nothing less.
  Mesh mesh;
  for (int j = 0; j <= 20; ++j) {
    for (int i = 0; i <= 20; ++i)
      mesh.vertices.push_back({0.01f * static_cast<float>(i), 0.01f * static_cast<float>(j), 1});
  }
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 20; ++i) {
      const int at = j * 21 + i;
      mesh.triangles.push_back({at, at + 1, at + 22});
      mesh.triangles.push_back({at, at + 22, at + 21});
    }
  }
  Simplifier simplifier(facets_of(mesh, [](const Vec3<float>&) { return Vec3<float>{0, 0, 1}; }));
  simplifier.simplify(1e-4, 0.1);
  const std::vector<Facet> coarse = simplifier.facets();
  EXPECT_LE(coarse.size(), 20U);
  double area = 0;
  for (const Facet& f : coarse)
    area += 0.5 * static_cast<double>(norm(cross(f.corner[1] - f.corner[0], f.corner[2] - f.corner[0])));
  EXPECT_NEAR(area, 0.04, 1e-6);
}

TEST(Simplify, LevelsAreChosenByTheErrorThatIsAllowed) {
  const Mesh ball = testing::ball_mesh(0.1, 40);
  const auto triangles = Triangles::of({{ball.vertices, ball.triangles}});
  EXPECT_EQ(&triangles->within(0), &triangles->exact());
  std::size_t last = triangles->exact().facets.size();
  for (const float error : {0.001f, 0.004f}) {
    EXPECT_LT(triangles->within(error).facets.size(), last);
    last = triangles->within(error).facets.size();
  }
}

TEST(Simplify, CopiesThatCastShadowsAreCoarserThanThoseThatAreSeenAndAsClose) {
  const Mesh ball = testing::ball_mesh(0.1, 40);
  const auto triangles = Triangles::of({{ball.vertices, ball.triangles}});
  constexpr float kError = 0.001f;
  const ClusteredMesh& casting = triangles->casting_within(kError);
  EXPECT_TRUE(casting.is_closed);
  EXPECT_LT(casting.facets.size(), 0.8 * static_cast<double>(triangles->within(kError).facets.size()));
  for (const Facet& facet : casting.facets) {
    const Vec3<float> middle = (1.0f / 3) * (facet.corner[0] + facet.corner[1] + facet.corner[2]);
    if (squared_norm(middle) == 0) continue;  // it fills a packet up
    EXPECT_NEAR(norm(middle), 0.1f, 4 * kError);
  }
}

}  // namespace
}  // namespace manyhands
