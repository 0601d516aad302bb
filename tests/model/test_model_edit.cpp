// Parts taken into a model that stands already: nothing tells it from one that was built at once.
#include <gtest/gtest.h>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/compose.h"
#include "manyhands/model/model_edit.h"
#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/dynamics/tree.h"
#include "tests/model/random_parts.h"

namespace manyhands {
namespace {

void expect_same(const Transform<double>& a, const Transform<double>& b) {
  EXPECT_LT(norm(a.p - b.p) + norm(a.R.x - b.R.x) + norm(a.R.y - b.R.y) + norm(a.R.z - b.R.z), 1e-12);
}

template <class Part>
void expect_equal_lists(std::span<const Part> a, std::span<const Part> b) {
  EXPECT_TRUE(std::ranges::equal(a, b));
}

void expect_same_bodies(const Model& a, const Model& b) {
  ASSERT_EQ(a.bodies().size(), b.bodies().size());
  EXPECT_EQ(a.nq(), b.nq());
  EXPECT_EQ(a.nv(), b.nv());
  for (std::size_t i = 0; i < a.bodies().size(); ++i) {
    const Body &x = a.bodies()[i], &y = b.bodies()[i];
    EXPECT_EQ(x.parent, y.parent);
    EXPECT_EQ(x.joint, y.joint);
    EXPECT_EQ(x.type, y.type);
    EXPECT_EQ((std::array{x.nq, x.nv}), (std::array{y.nq, y.nv}));
    if (x.type != JointType::kMocap) {  // whose are indices of nothing
      EXPECT_EQ((std::array{x.iq, x.iv}), (std::array{y.iq, y.iv}));
    }
    EXPECT_NEAR(x.inertia.m, y.inertia.m, 1e-12);
    EXPECT_LT(norm(x.inertia.h - y.inertia.h), 1e-12);
    expect_same(x.X_PF, y.X_PF);
    expect_equal_lists(a.links_of(BodyId(i)), b.links_of(BodyId(i)));
  }
  expect_equal_lists(a.dof_parent(), b.dof_parent());
  expect_equal_lists(a.dof_joint(), b.dof_joint());
  expect_equal_lists(a.dof_q(), b.dof_q());
  expect_equal_lists(a.dof_damping(), b.dof_damping());
}

void expect_same_links(const Model& a, const Model& b) {
  ASSERT_EQ(a.links().size(), b.links().size());
  ASSERT_EQ(a.joints().size(), b.joints().size());
  for (std::size_t i = 0; i < a.links().size(); ++i) {
    const Link &x = a.links()[i], &y = b.links()[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.parent, y.parent);
    EXPECT_EQ(x.joint, y.joint);
    EXPECT_EQ(x.body, y.body);
    expect_same(x.X_BL, y.X_BL);
    EXPECT_EQ(a.link_id(x.name), LinkId(i));
    expect_equal_lists(a.children_of(LinkId(i)), b.children_of(LinkId(i)));
    expect_equal_lists(a.geoms_of(LinkId(i)), b.geoms_of(LinkId(i)));
  }
  for (std::size_t i = 0; i < a.joints().size(); ++i) {
    const Joint &x = a.joints()[i], &y = b.joints()[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.parent, y.parent);
    EXPECT_EQ(x.child, y.child);
    EXPECT_EQ(x.type, y.type);
    if (x.type != JointType::kMocap) {
      EXPECT_EQ((std::array{x.iq, x.iv}), (std::array{y.iq, y.iv}));
    }
    EXPECT_EQ(a.joint_id(x.name), JointId(i));
  }
  ASSERT_EQ(a.frames().size(), b.frames().size());
  for (std::size_t i = 0; i < a.frames().size(); ++i) {
    EXPECT_EQ(a.frames()[i].name, b.frames()[i].name);
    EXPECT_EQ(a.frames()[i].body, b.frames()[i].body);
    expect_same(a.frames()[i].X_BF, b.frames()[i].X_BF);
    EXPECT_EQ(a.frame_id(a.frames()[i].name), FrameId(i));
  }
}

void expect_same_couplings(const Model& a, const Model& b) {
  ASSERT_EQ(a.geoms().size(), b.geoms().size());
  for (std::size_t i = 0; i < a.geoms().size(); ++i) {
    EXPECT_EQ(a.geoms()[i].name, b.geoms()[i].name);
    EXPECT_EQ(a.geoms()[i].link, b.geoms()[i].link);
    if (!a.geoms()[i].name.empty()) {
      EXPECT_EQ(a.find_geom(a.geoms()[i].name), GeomId(i));
    }
  }
  ASSERT_EQ(a.equalities().size(), b.equalities().size());
  for (std::size_t i = 0; i < a.equalities().size(); ++i) {
    const EqualityConstraint &x = a.equalities()[i], &y = b.equalities()[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ((std::array{x.link_a, x.link_b}), (std::array{y.link_a, y.link_b}));
    EXPECT_EQ((std::array{x.joint_a, x.joint_b}), (std::array{y.joint_a, y.joint_b}));
  }
  ASSERT_EQ(a.nu(), b.nu());
  for (std::size_t i = 0; i < a.actuators().size(); ++i) EXPECT_EQ(a.actuators()[i].joint, b.actuators()[i].joint);
  ASSERT_EQ(a.exclusions().size(), b.exclusions().size());
  for (std::size_t i = 0; i < a.exclusions().size(); ++i) {
    EXPECT_EQ(a.exclusions()[i].a, b.exclusions()[i].a);
    EXPECT_EQ(a.exclusions()[i].b, b.exclusions()[i].b);
  }
}

void expect_same_trees(const Tree<double>& a, const Tree<double>& b) {
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const TreeBody<double>&x = a.bodies[i], &y = b.bodies[i];
    EXPECT_EQ((std::array{x.parent, x.nv}), (std::array{y.parent, y.nv}));
    if (x.type != JointType::kMocap) {
      EXPECT_EQ((std::array{x.iq, x.iv}), (std::array{y.iq, y.iv}));
    }
    EXPECT_EQ(x.turn, y.turn);
  }
  EXPECT_EQ((std::array{a.nb, a.nq, a.nv}), (std::array{b.nb, b.nq, b.nv}));
  EXPECT_EQ(a.dof_parent, b.dof_parent);
  EXPECT_EQ(a.root_dof, b.root_dof);
  EXPECT_EQ(a.end_dof, b.end_dof);
  EXPECT_EQ(a.last_dof, b.last_dof);
  EXPECT_EQ(a.path, b.path);
  EXPECT_EQ(a.path_begin, b.path_begin);
  EXPECT_EQ(a.M_row, b.M_row);
  EXPECT_EQ(a.M_size, b.M_size);
  EXPECT_EQ(a.dofs_from_leaves, b.dofs_from_leaves);
  EXPECT_EQ(a.mocap_bodies, b.mocap_bodies);
  EXPECT_EQ(a.dof_q, b.dof_q);
  EXPECT_EQ(a.dof_limited, b.dof_limited);
  EXPECT_EQ(a.cluster_begin, b.cluster_begin);
  EXPECT_EQ(a.cluster_end, b.cluster_end);
  EXPECT_EQ(a.dof_drive, b.dof_drive);
  ASSERT_EQ(a.equalities.size(), b.equalities.size());
  EXPECT_EQ(a.equality_rows, b.equality_rows);
  for (std::size_t i = 0; i < a.equalities.size(); ++i) {
    const TreeEquality<double>&x = a.equalities[i], &y = b.equalities[i];
    EXPECT_EQ((std::array{x.body_a, x.body_b, x.dof_a, x.dof_b, x.q_a, x.q_b, x.row}),
              (std::array{y.body_a, y.body_b, y.dof_a, y.dof_b, y.q_a, y.q_b, y.row}));
  }
  ASSERT_EQ(a.actuators.size(), b.actuators.size());
  for (std::size_t i = 0; i < a.actuators.size(); ++i) {
    EXPECT_EQ((std::array{a.actuators[i].law, a.actuators[i].q}), (std::array{b.actuators[i].law, b.actuators[i].q}));
  }
}

void expect_same_colliders(const Colliders<double>& a, const Colliders<double>& b) {
  ASSERT_EQ(a.geoms.size(), b.geoms.size());
  EXPECT_EQ(a.collider_of, b.collider_of);
  for (std::size_t i = 0; i < a.geoms.size(); ++i) {
    const Collider<double>&x = a.geoms[i], &y = b.geoms[i];
    EXPECT_EQ((std::array{x.geom, x.body, x.root, x.neighbour, x.link, x.base}),
              (std::array{y.geom, y.body, y.root, y.neighbour, y.link, y.base}));
    expect_same(x.X_BG, y.X_BG);
  }
  ASSERT_EQ(a.pairs.size(), b.pairs.size());
  for (std::size_t i = 0; i < a.pairs.size(); ++i) {
    EXPECT_EQ((std::array{a.pairs[i].a, a.pairs[i].b, a.pairs[i].manifold}),
              (std::array{b.pairs[i].a, b.pairs[i].b, b.pairs[i].manifold}));
  }
}

TEST(ModelEdit, PartsTakenInOneAfterTheOtherAreAsIfBuiltTogether) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    ModelBuilder together;
    Model model = together.build();
    Tree<double> tree(model);
    Colliders<double> colliders(model);
    for (int i = 0; i < 5; ++i) {
      const Model part = testing::random_parts(random, std::string(1, static_cast<char>('a' + i)), seed % 2 == 1);
      append(together, part);
      const Insertion at = ModelEdit(model).insert(part);
      tree.insert(Tree<double>(part), at);
      colliders.insert(Colliders<double>(part), at, model);
      colliders.list_pairs(PairSearch::kListed);
      const Model expected = together.build();
      expect_same_bodies(model, expected);
      expect_same_links(model, expected);
      expect_same_couplings(model, expected);
      expect_same_trees(tree, Tree<double>(expected));
      expect_same_colliders(colliders, Colliders<double>(expected));
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(ModelEdit, ATakenNameChangesNothing) {
  std::mt19937 random(7);
  Model model = testing::random_parts(random, "a");
  const Model part = testing::random_parts(random, "a");
  const std::size_t links = model.links().size();
  EXPECT_THROW(ModelEdit(model).insert(part), ModelError);
  EXPECT_EQ(model.links().size(), links);
}

TEST(ModelEdit, ForgottenNamesAreFree) {
  std::mt19937 random(3);
  Model model = testing::random_parts(random, "a");
  const std::size_t links = model.links().size();
  for (std::size_t i = 1; i < links; ++i) ModelEdit(model).forget(LinkId(i));
  EXPECT_THROW((void)model.link_id("a0"), std::out_of_range);
  EXPECT_THROW((void)model.frame_id("a0"), std::out_of_range);
  random.seed(3);
  ModelEdit(model).insert(testing::random_parts(random, "a"));
  EXPECT_EQ(model.link_id("a0"), LinkId(links));
}

}  // namespace
}  // namespace manyhands
