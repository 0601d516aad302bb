// Bodies of make_batch_lanes, included by the files that instantiate it.
#pragma once

#include "manyhands/physics/step/energy_balance.h"
#include "manyhands/physics/world/batch_lanes.h"

namespace manyhands {

template <Number T>
class BatchLanesOf final : public BatchLanes {
 public:
  using R = real_t<T>;
  static constexpr auto W = static_cast<std::size_t>(width_v<T>);

  BatchLanesOf(const Model& model, int num_worlds, float time_step, int num_workers)
      : time_step_(time_step), system_(model), frames_(model.frames().begin(), model.frames().end()) {
    for (const Geom& geom : model.geoms()) link_of_geom_.push_back(geom.link.index());
    const auto n = static_cast<std::size_t>(num_worlds);
    blocks_.assign((n + W - 1) / W, WorldBlock<T>(model, system_.contact_numbers()));
    for (std::size_t i = n; i < blocks_.size() * W; ++i) world(i).extras.frozen[0] = 1;  // lanes without a world rest
    for (int worker = 0; worker < num_workers; ++worker) {
      workers_.push_back({StepWorkspace<T>(system_), Workspace<T>(system_.tree)});
      blocks_[0].keep_moved(workers_.back().kept);
    }
  }

  [[nodiscard]] int width() const override { return static_cast<int>(W); }
  [[nodiscard]] const SolverSettings& solver() const override { return system_.solver; }
  void set_solver(const SolverSettings& settings) override { system_.solver = settings; }
  [[nodiscard]] Colliders<float>& colliders() override { return system_.colliders; }
  [[nodiscard]] WorldView<float> world(std::size_t world) override { return blocks_[world / W].view(world % W); }

  void step(int n, ThreadPool& pool) override {
    pool.for_each(static_cast<int>(blocks_.size()), [&](int block, int worker) {
      step_block(blocks_[static_cast<std::size_t>(block)], workers_[static_cast<std::size_t>(worker)], n);
    });
  }

  void frame_motion(BodyId body, const Transform<float>& X_BF, ThreadPool& pool, std::span<float> pose,
                    std::span<float> velocity) override {
    pool.for_each(static_cast<int>(blocks_.size()), [&](int block, int worker) {
      write_frame(static_cast<std::size_t>(block), workers_[static_cast<std::size_t>(worker)].step.dynamics, body, X_BF,
                  pose, velocity);
    });
  }

 private:
  /// What a worker lends to the block that it steps.
  struct Worker {
    StepWorkspace<T> step;
    Workspace<T> scratch;
    std::vector<T> kept{};  ///< of the state before the step
    EnergyBalance<T> balance{};
  };

  static T zero() { return T(R(0)); }
  static T one() { return T(R(1)); }

  void step_block(WorldBlock<T>& block, Worker& worker, int n) {
    block.extras.advanced[0] = block.extras.deepest[0] = block.extras.unsettled[0] = zero();
    for (int i = 0; i < n; ++i) {
      block.keep_moved(worker.kept);
      const bool pushed = any(block.extras.pushed[0] > zero());
      if (pushed) {
        place_mocap(system_.tree, block.state.mocap(), worker.step.dynamics);
        forward_kinematics(system_.tree, block.state.q(), worker.step.dynamics);
        block.push(system_.tree, frames_, worker.step.dynamics);
      }
      manyhands::step(system_, block.params, time_step_, block.state, worker.step);
      if (pushed) block.restore_tau(worker.kept);
      freeze(block, worker);
      note_step(block, worker.step);
    }
    if (n > 0) sum_contacts(block, worker.step);
  }

  /// Worlds whose numbers have stopped being finite, or that make motion from nothing, go back to where they were, and
  /// stay there without a warm start.
  void freeze(WorldBlock<T>& block, Worker& worker) {
    T &frozen = block.extras.frozen[0], &advanced = block.extras.advanced[0];
    const T *const q = worker.kept.data(), *const v = q + (block.state.v() - block.state.q());
    const auto made = keep_balance(system_.tree, block.params, time_step_, q, v, worker.step.dynamics, block.state,
                                   worker.scratch, worker.balance);
    const auto good = (frozen == zero()) & block.is_finite() & !made;
    advanced = advanced + select(good, one(), zero());
    if (all(good)) return;
    frozen = select(good, zero(), one());
    block.put_back(good, worker.kept);
  }

  void note_step(WorldBlock<T>& block, const StepWorkspace<T>& ws) {
    T penetration = zero();
    for (const ContactPoint<T>& point : ws.contact.problem.points) {
      penetration = max(penetration, select(is_finite(point.phi), -point.phi, zero()));
    }
    penetration = select(block.extras.frozen[0] > zero(), zero(), penetration);
    block.extras.penetration[0] = penetration;
    block.extras.deepest[0] = max(block.extras.deepest[0], penetration);
    const T unsettled = select(block.extras.frozen[0] > zero(), zero(), ws.contact.unsettled);
    block.extras.unsettled[0] = max(block.extras.unsettled[0], unsettled);
  }

  /// What the contacts of the last step do to each link, and how many there are.
  void sum_contacts(WorldBlock<T>& block, const StepWorkspace<T>& ws) {
    const T inverse_h(R(1) / time_step_);
    const auto lives = block.extras.frozen[0] == zero();
    for (ContactForces<T>& wrench : block.extras.wrench) wrench = {};
    T touching = zero();
    const ContactProblem<T>& problem = ws.contact.problem;
    for (std::size_t i = 0; i < problem.points.size(); ++i) {
      const ContactPoint<T>& point = problem.points[i];
      const ContactPatch<T>& patch = problem.patches[point.patch];
      const Vec3<T>& impulse = ws.contact.iterate.points[i].impulse;
      const auto touches = lives & is_finite(point.phi) & ((impulse.x > zero()) | (point.phi <= zero()));
      touching = touching + select(touches, one(), zero());
      const PointForces<T> forces = point_forces(patch, impulse, inverse_h, touches);
      visit_sides<R>(system_.colliders.pairs[patch.pair], [&](std::size_t collider, R sign) {
        const std::size_t link = link_of(collider);
        add_forces(forces, point.p - link_origin(frames_[link], ws.dynamics), sign, block.extras.wrench[link]);
      });
    }
    block.extras.touching[0] = touching;
    for (std::size_t j = 0; j < problem.torsions.size(); ++j) {
      const ContactPoint<T>& point = problem.points[problem.torsions[j].point];
      const ContactPatch<T>& patch = problem.patches[point.patch];
      const Vec3<T>& impulse = ws.contact.iterate.torsions[j].impulse;
      const Vec3<T> moment = torsion_moment(patch, impulse, inverse_h, lives & is_finite(point.phi));
      visit_sides<R>(system_.colliders.pairs[patch.pair], [&](std::size_t collider, R sign) {
        Vec3<T>& sum = block.extras.wrench[link_of(collider)].friction.n;
        sum = fma(T(sign), moment, sum);
      });
    }
  }

  [[nodiscard]] std::size_t link_of(std::size_t collider) const {
    return link_of_geom_[system_.colliders.geoms[collider].geom];
  }

  void write_frame(std::size_t index, Workspace<T>& ws, BodyId body, const Transform<float>& X_BF,
                   std::span<float> pose, std::span<float> velocity) {
    const State<T>& state = blocks_[index].state;
    place_mocap(system_.tree, state.mocap(), ws);
    for (std::size_t b = 1; b < system_.tree.bodies.size(); ++b) {
      place(system_.tree, b, state.q(), ws);
      move(system_.tree, b, state.v(), ws);
    }
    const Transform<T> X = frame_pose(body, X_BF, ws);
    const Motion<T> V =
        at_point(ws.V[body.index()], ws.R_WB[body.index()] * broadcast<T>(X_BF.p) + ws.p_OB[body.index()]);
    const std::size_t n = pose.size() / 12;
    for (std::size_t k = 0; k < W && index * W + k < n; ++k) {
      const std::size_t world = index * W + k;
      const auto lane_k = static_cast<int>(k);
      for (std::size_t i = 0; i < 12; ++i) pose[12 * world + i] = lane((&X.R.x.x)[i], lane_k);
      for (std::size_t i = 0; i < 6; ++i) velocity[6 * world + i] = lane((&V.w.x)[i], lane_k);
    }
  }

  R time_step_;
  System<R> system_;
  std::vector<Frame> frames_;  // links' first
  std::vector<std::size_t> link_of_geom_;
  std::vector<WorldBlock<T>> blocks_;
  std::vector<Worker> workers_;
};

}  // namespace manyhands
