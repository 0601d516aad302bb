// The worlds of a scene in contact, in any number type: stepped whole or stage by stage, and looked at.
#pragma once

#include "benchmarks/contact_scenes.h"
#include "benchmarks/support.h"
#include "manyhands/physics/world/contact_residuals.h"

namespace benchmarks {

using namespace manyhands;

inline constexpr int kSettlingSteps = 500, kObservedSteps = 500;
inline constexpr double kGravity = 9.81;
inline constexpr double kStillPlace = 1e-4;  // how far things may stand from where they belong [m]

/// What was seen of a scene at rest, the worst of all worlds.
struct Observation {
  double contacts = 0;     ///< points that carry something, mean of the worlds
  double iterations = 0;   ///< mean of the steps
  double penetration = 0;  ///< deepest [m]
  double creep = 0;        ///< fastest, of a cube: against the hand that holds it, else in the world [m/s]
  double law = 0;          ///< how far a contact is from Signorini's and Coulomb's laws, at worst [m/s]
  std::string wrong;       ///< why the scene is not what it claims to be, or empty
};

/// All worlds of a scene in blocks of lanes.
template <Number T>
class ContactWorlds {
  using R = real_t<T>;
  static constexpr int kBlocks = kContactWorlds / width_v<T>;

 public:
  ContactWorlds(ContactScene scene, const Model& model, std::span<const ContactStart> starts)
      : scene_(scene),
        model_(model),
        system_(model),
        params_(model),
        ws_(system_),
        states_(kBlocks, StateStorage<T>(model, system_.contact_numbers())) {
    for (std::size_t i = 0; i < kPandaJoints; ++i) {
      params_.motor_kp[i] = R(0.1);
      params_.motor_kd[i] = R(1);
      params_.motor_max_force[i] = static_cast<R>(motor_forces(scene)[i]);
    }
    for (std::size_t k = 0; k < starts.size(); ++k) start(starts[k], static_cast<int>(k));
  }

  void step() {
    for (State<T>& state : states_) manyhands::step(system_, params_, static_cast<R>(kContactTimeStep), state, ws_);
  }

  /// The same, with the seconds of each stage added to `spent`.
  void step_in_stages(std::array<double, 5>& spent) {
    for (State<T>& state : states_) step_in_stages(state, spent);
  }

  /// Lets the scene come to rest, then looks at it for a while.
  Observation observe() {
    for (int i = 0; i < kSettlingSteps; ++i) step();
    Observation seen;
    const std::vector<Vec3<double>> before = cube_places();
    for (int i = 0; i < kObservedSteps; ++i) {
      for (State<T>& state : states_) {
        manyhands::step(system_, params_, static_cast<R>(kContactTimeStep), state, ws_);
        seen.iterations += static_cast<double>(ws_.contact.iterations) / (kObservedSteps * kBlocks);
        if (i + 1 == kObservedSteps) look_at_contacts(state, seen);
      }
    }
    const std::vector<Vec3<double>> after = cube_places();
    for (std::size_t i = 0; i < after.size(); ++i) {
      seen.creep = std::max(seen.creep, norm(after[i] - before[i]) / (kObservedSteps * kContactTimeStep));
    }
    return seen;
  }

  /// Configurations and velocities of all worlds.
  [[nodiscard]] Results results() const {
    std::vector<T> rows;
    for (const State<T>& state : states_) {
      rows.insert(rows.end(), state.q(), state.q() + model_.nq());
      rows.insert(rows.end(), state.v(), state.v() + model_.nv());
    }
    return unpack<T>(rows, static_cast<std::size_t>(model_.nq() + model_.nv()));
  }

 private:
  void start(const ContactStart& start, int world) {
    State<T>& state = states_[static_cast<std::size_t>(world / width_v<T>)];
    const int k = world % width_v<T>;
    for (std::size_t i = 0; i < kPandaJoints; ++i) {
      set_lane(state.q()[i], k, static_cast<R>(start.q[i]));
      set_lane(state.target_q()[i], k, static_cast<R>(start.target[i]));
    }
    std::size_t next = kPandaJoints;
    for (const Vec3<double>& p : start.cubes) {
      const std::array pose{p.x, p.y, p.z, 0.0, 0.0, std::sin(start.yaw / 2), std::cos(start.yaw / 2)};
      for (const double number : pose) set_lane(state.q()[next++], k, static_cast<R>(number));
    }
  }

  void step_in_stages(State<T>& state, std::array<double, 5>& spent) {
    const Tree<R>& tree = system_.tree;
    const R h = static_cast<R>(kContactTimeStep);
    double last = wall_seconds();
    const auto lap = [&](std::size_t stage) {
      const double now = wall_seconds();
      spent[stage] += now - last;
      last = now;
    };
    bias_and_mass_matrix(tree, params_, state.q(), state.v(), ws_.dynamics);
    lap(0);
    const std::span<const ColliderPair> pairs = find_touches(system_.colliders, params_, h, state, ws_);
    lap(1);
    ContactSolver<T>& contact = ws_.contact;
    assemble(tree, system_.colliders, pairs, params_, h, state, ws_.collision, ws_.dynamics, contact);
    warm_start(contact.problem, std::span<const Touch<T>>(ws_.collision.touches), state, contact.iterate);
    lap(2);
    solve(system_.solver, contact);
    lap(3);
    store_warm_start(contact.problem, contact.iterate, state);
    add_velocity_change(state, static_cast<std::size_t>(tree.nv));
    integrate_configuration(tree, state.v(), T(h), state.q());
    correct_free_fall(tree, params_, h, contact, ws_.resting, state);
    lap(4);
  }

  /// Every cube of every world: in the hand's frame where it is grasped, else in the world.
  std::vector<Vec3<double>> cube_places() {
    std::vector<Vec3<double>> places;
    const Frame& hand = model_.frame(model_.frame_id("panda_grasptarget"));
    for (const State<T>& state : states_) {
      forward_kinematics(system_.tree, state.q(), ws_.dynamics);
      const Transform<T> X_WH = frame_pose(hand.body, broadcast<R>(hand.X_BF), ws_.dynamics);
      for (int cube = 0; cube < cubes_of(scene_); ++cube) {
        const T* q = state.q() + kPandaJoints + 7 * cube;
        Vec3<T> p{q[0], q[1], q[2]};
        if (scene_ == ContactScene::kGrasp) p = transpose_times(X_WH.R, p - X_WH.p);
        for (int k = 0; k < width_v<T>; ++k) {
          const Vec3<R> own = lane(p, k);
          places.push_back(broadcast<double>(own));
        }
      }
    }
    return places;
  }

  /// Who carries whom in one world: points between fingers and cubes, cubes and table, cubes and each other.
  struct Census {
    std::array<int, 2> fingers{};
    int table = 0, cubes = 0;
    double weight = 0;  ///< on the table [N]
    [[nodiscard]] int all() const { return fingers[0] + fingers[1] + table + cubes; }
  };

  void look_at_contacts(const State<T>& state, Observation& seen) const {
    const auto body = [&](const char* link) { return model_.link(model_.link_id(link)).body.index(); };
    const std::array fingers{body("panda_leftfinger"), body("panda_rightfinger")};
    for (int k = 0; k < width_v<T>; ++k) {
      Census census;
      for (std::size_t i = 0; i < ws_.contact.problem.points.size(); ++i) {
        const ContactPoint<T>& point = ws_.contact.problem.points[i];
        const ContactPatch<T>& patch = ws_.contact.problem.patches[point.patch];
        const PointResiduals<T> off = point_residuals(ws_.contact, i);
        seen.law = std::max({seen.law, static_cast<double>(lane(off.penetration_rate, k)),
                             static_cast<double>(lane(off.dissipation, k))});
        const double impulse = static_cast<double>(lane(ws_.contact.iterate.points[i].impulse.x, k));
        if (!(impulse > 0)) continue;
        seen.penetration = std::max(seen.penetration, -static_cast<double>(lane(point.phi, k)));
        const std::size_t a = patch.body_a(), b = patch.body_b();
        bool finger = false;
        for (std::size_t f = 0; f < 2; ++f) {
          if (a != fingers[f] && b != fingers[f]) continue;
          ++census.fingers[f];
          finger = true;
        }
        if (finger) continue;
        const bool table = a == 0 || b == 0;
        ++(table ? census.table : census.cubes);
        if (table) census.weight += impulse / kContactTimeStep;
      }
      seen.contacts += static_cast<double>(census.all()) / kContactWorlds;
      if (seen.wrong.empty()) seen.wrong = what_is_wrong(state, census, k);
    }
  }

  std::string what_is_wrong(const State<T>& state, const Census& census, int k) const {
    const bool touched = census.fingers[0] + census.fingers[1] > 0;
    const auto height = [&](int cube) { return static_cast<double>(lane(state.q()[kPandaJoints + 7 * cube + 2], k)); };
    switch (scene_) {
      case ContactScene::kTable:
        if (touched) return "the hand touches the cube";
        if (std::abs(height(0) - kCubeSize / 2) > kStillPlace) return "the cube does not lie on the table";
        if (std::abs(census.weight - kGravity) > 0.01 * kGravity) return "the table does not carry the cube";
        return {};
      case ContactScene::kGrasp:
        if (census.fingers[0] == 0 || census.fingers[1] == 0) return "a finger does not touch the cube";
        if (height(0) < 5 * kCubeSize) return "the cube is not held in the air";
        return {};
      case ContactScene::kPress:
        if (!touched) return "the hand does not touch the cubes";
        if (census.cubes == 0 || census.weight < 2.5 * kGravity) return "the hand does not press upon the stack";
        if (std::abs(height(1) - 1.5 * kCubeSize) > kStillPlace) return "the upper cube does not stand on the lower";
        return {};
    }
    return {};
  }

  ContactScene scene_;
  const Model& model_;
  System<R> system_;
  ParamsStorage<R> params_;
  StepWorkspace<T> ws_;
  std::vector<StateStorage<T>> states_;  // (kBlocks)
};

}  // namespace benchmarks
