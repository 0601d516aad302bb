// Couplings between two joints of one tree: of a joint with its ancestor, its descendant, or one on another branch.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/model/compose.h"
#include "manyhands/physics/dynamics/crba.h"
#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

using testing::Generator;
using testing::uniform;

constexpr double kMassA = 1, kMassB = 3;  // [kg]

/// Slider b on slider a, both along z. The second joint of the coupling is the driven one: q_2 = ratio q_1.
std::shared_ptr<const Model> sliders(double ratio, bool ancestor_drives, EqualityType type) {
  ModelBuilder builder("sliders");
  const SymMat3<double> inertia{0.01, 0.01, 0.01, 0, 0, 0};
  const LinkId a = builder.add_link("a", {.mass = kMassA, .inertia = inertia});
  const LinkId b = builder.add_link("b", {.mass = kMassB, .inertia = inertia});
  const auto slide = [&](LinkId parent, LinkId child, const std::string& name) {
    return builder.add_joint(
        {.name = name, .type = JointType::kPrismatic, .parent = parent, .child = child, .axis = {0, 0, 1}});
  };
  const JointId joint_a = slide(builder.world(), a, "slide_a"), joint_b = slide(a, b, "slide_b");
  builder.add_equality({.name = "coupling",
                        .type = type,
                        .joint_a = ancestor_drives ? joint_a : joint_b,
                        .joint_b = ancestor_drives ? joint_b : joint_a,
                        .ratio = ratio});
  return std::make_shared<const Model>(builder.build());
}

/// Their velocities after 1 s of free fall from rest: one degree of freedom, (a, b) moving as (1, r).
std::array<double, 2> fallen(double ratio, bool ancestor_drives) {
  const double r = ancestor_drives ? ratio : 1 / ratio, height = 1 + r;
  const double a = -9.81 * (kMassA + kMassB * height) / (kMassA + kMassB * height * height);
  return {a, r * a};
}

struct Fall {
  double ratio;
  bool ancestor_drives;
  EqualityType type;
};

std::vector<Fall> falls() {
  std::vector<Fall> all;
  for (const EqualityType type : {EqualityType::kJoint, EqualityType::kGear})
    for (const bool ancestor_drives : {true, false})
      for (const double ratio : {1.0, -0.5, 4.0}) all.push_back({ratio, ancestor_drives, type});
  return all;
}

TEST(Couplings, ChainedSlidersFallByFormula) {
  for (const auto& [ratio, ancestor_drives, type] : falls()) {
    World world(sliders(ratio, ancestor_drives, type), 0.002);
    world.step(500);
    const auto [a, b] = fallen(ratio, ancestor_drives);
    EXPECT_NEAR(world.v()[0], a, 1e-9) << "ratio " << ratio << ", the ancestor drives: " << ancestor_drives;
    EXPECT_NEAR(world.v()[1], b, 1e-9) << "ratio " << ratio << ", the ancestor drives: " << ancestor_drives;
  }
}

/// 500 additions in float, each to half a unit in the last place of at most 8 m/s or 40 m/s.
TEST(Couplings, ChainedSlidersFallByFormulaInLanes) {
  for (const auto& [ratio, ancestor_drives, type] : falls()) {
    for (const int lanes : {1, 4, 8, 16}) {
      Batch batch(sliders(ratio, ancestor_drives, type), 3, 0.002, {.num_threads = 1, .lanes = lanes});
      batch.step(500);
      const auto [a, b] = fallen(ratio, ancestor_drives);
      const double tolerance = 500 * 6e-8 * std::max(std::abs(a), std::abs(b));
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(static_cast<double>(batch.v()[2 * i]), a, tolerance) << "ratio " << ratio << ", lanes " << lanes;
        EXPECT_NEAR(static_cast<double>(batch.v()[2 * i + 1]), b, tolerance)
            << "ratio " << ratio << ", lanes " << lanes;
        EXPECT_EQ(batch.flags()[i], 0);
      }
    }
  }
}

/// d'Alembert's principle: what the coupling does to the joints is (-ratio, 1) times one number, and nothing to any
/// other; and the joints move together. On random trees, in which the two are often one above the other.
TEST(Couplings, OnRandomTreesTheImpulseIsAlongTheRow) {
  int related = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Generator rng(seed);
    ModelBuilder builder = builder_of(testing::random_tree(seed, 8));
    std::vector<JointId> single;
    for (std::size_t i = 0; i < builder.joints().size(); ++i) {
      const JointType type = builder.joints()[i].type;
      if (type == JointType::kRevolute || type == JointType::kContinuous || type == JointType::kPrismatic)
        single.push_back(JointId(i));
    }
    if (single.size() < 2) continue;
    const std::size_t first = rng() % single.size(), other = (first + 1 + rng() % (single.size() - 1)) % single.size();
    const double ratio = uniform(rng, -3, 3);
    builder.add_equality({.name = "coupling",
                          .type = EqualityType::kGear,
                          .joint_a = single[first],
                          .joint_b = single[other],
                          .ratio = ratio});
    const auto model = std::make_shared<const Model>(builder.build());
    const System<double> system(*model);
    const ParamsStorage<double> params(*model);
    StateStorage<double> state(*model, system.contact_numbers());
    StepWorkspace<double> ws(system);
    const std::vector<double> q = testing::random_configuration(*model, rng);
    std::copy(q.begin(), q.end(), state.q());
    const auto a = static_cast<std::size_t>(model->joint(single[first]).iv),
               b = static_cast<std::size_t>(model->joint(single[other]).iv);
    const std::vector<double> v = testing::random_numbers(static_cast<std::size_t>(model->nv()), rng);
    std::copy(v.begin(), v.end(), state.v());
    step(system, params, 1e-3, state, ws);
    // M and the smooth impulse are those of the step's beginning.
    std::vector<double> pulled(v.size());
    multiply_tree_matrix<double>(system.tree, ws.dynamics.M.data(), state.dv(), pulled.data());
    double largest = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      largest = std::max(largest, std::abs(pulled[i]));
      pulled[i] -= ws.contact.problem.joints.smooth[i];
    }
    const double tolerance = 1e-10 * (1 + largest);
    EXPECT_NEAR(state.v()[b], ratio * state.v()[a], 1e-9 * (1 + std::abs(state.v()[b]))) << "seed " << seed;
    EXPECT_NEAR(pulled[a], -ratio * pulled[b], tolerance) << "seed " << seed;
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (i == a || i == b) continue;
      EXPECT_NEAR(pulled[i], 0, tolerance) << "seed " << seed << ", dof " << i;
    }
    for (std::size_t low = std::min(a, b), k = std::max(a, b);;) {
      const int parent = model->dof_parent()[k];
      if (parent < 0) break;
      k = static_cast<std::size_t>(parent);
      if (k == low) ++related;
    }
  }
  EXPECT_GT(related, 100);
}

/// Two rods of a chain, the second turning as the first does.
std::shared_ptr<const Model> folding_chain(double ratio, bool ancestor_drives, double angle) {
  ModelBuilder builder("folding chain");
  LinkId parent = builder.world();
  for (const std::string name : {"upper", "lower"}) {
    const LinkId rod =
        builder.add_link(name, {.mass = 1, .com = {0, 0, -0.25}, .inertia = {0.02, 0.02, 0.0005, 0, 0, 0}});
    const bool lower = parent != builder.world();
    builder.add_joint({.name = name,
                       .type = JointType::kContinuous,
                       .parent = parent,
                       .child = rod,
                       .X_PF = {Mat3<double>::identity(), {0, 0, lower ? -0.5 : 0.0}},
                       .axis = {0, 1, 0},
                       .initial = {lower ? (ancestor_drives ? ratio * angle : angle / ratio) : angle}});
    parent = rod;
  }
  builder.add_equality({.name = "fold",
                        .type = EqualityType::kJoint,
                        .joint_a = JointId(ancestor_drives ? 0 : 1),
                        .joint_b = JointId(ancestor_drives ? 1 : 0),
                        .ratio = ratio});
  return std::make_shared<const Model>(builder.build());
}

/// Semi-implicit Euler drifts in proportion to its step; an impulse that is not along the row would do so at any step.
TEST(Couplings, ACoupledChainKeepsItsEnergyAsTheStepShrinks) {
  for (const bool ancestor_drives : {true, false}) {
    for (const double ratio : {1.0, -2.0, 0.5}) {
      const std::string what = "ratio " + std::to_string(ratio) + (ancestor_drives ? ", driven" : ", driving");
      std::vector<double> drifts;
      for (const double h : {0.001, 0.0005}) {
        World world(folding_chain(ratio, ancestor_drives, 1.3), h);
        const auto total = [&] { return world.energy().kinetic + world.energy().potential; };
        const double start = total();
        double worst = 0;
        for (int i = 0; i < static_cast<int>(std::lround(10 / h)); ++i) {
          world.step();
          worst = std::max(worst, std::abs(total() - start));
        }
        const double gap = ancestor_drives ? world.q()[1] - ratio * world.q()[0] : world.q()[0] - ratio * world.q()[1];
        EXPECT_NEAR(gap, 0, 1e-9);
        drifts.push_back(worst);
      }
      EXPECT_LT(drifts[1], 0.6 * drifts[0]) << what;
    }
  }
}

}  // namespace
}  // namespace manyhands
