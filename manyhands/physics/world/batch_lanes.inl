// Bodies of make_batch_lanes, included by the files that instantiate it.
#pragma once

#include "manyhands/physics/world/batch_lanes.h"

namespace manyhands {

template <Number T>
class BatchLanesOf final : public BatchLanes {
 public:
  using R = real_t<T>;
  static constexpr auto W = static_cast<std::size_t>(width_v<T>);

  BatchLanesOf(const Model& model, int num_worlds, float time_step, int num_workers)
      : time_step_(time_step),
        system_(model),
        frames_(model.frames().begin(), model.frames().end()),
        links_(model.links().size()) {
    for (const Geom& geom : model.geoms()) link_of_geom_.push_back(geom.link.index());
    const auto n = static_cast<std::size_t>(num_worlds);
    blocks_.assign((n + W - 1) / W, Block(model, system_));
    for (std::size_t i = n; i < blocks_.size() * W; ++i) extras(i).frozen = 1;  // lanes without a world rest
    for (int worker = 0; worker < num_workers; ++worker) workers_.emplace_back(model, system_);
  }

  [[nodiscard]] int width() const override { return static_cast<int>(W); }
  [[nodiscard]] int num_blocks() const override { return static_cast<int>(blocks_.size()); }
  [[nodiscard]] const SolverSettings& solver() const override { return system_.solver; }
  void set_solver(const SolverSettings& settings) override { system_.solver = settings; }
  [[nodiscard]] Colliders<float>& colliders() override { return system_.colliders; }

  [[nodiscard]] Strided<float> state(std::size_t world) override {
    const std::span<T> numbers = blocks_[world / W].state.numbers();
    return {reinterpret_cast<float*>(numbers.data()) + world % W, W, numbers.size()};
  }
  [[nodiscard]] ParamsView<float> params(std::size_t world) override {
    return view(blocks_[world / W].params, world % W);
  }
  [[nodiscard]] BatchExtras extras(std::size_t world) override {
    Block& block = blocks_[world / W];
    const std::size_t k = world % W;
    const auto one = [&](T& number) -> float& { return reinterpret_cast<float*>(&number)[k]; };
    return {.link_mass = lane_of<float>(block.link_mass, k, W),
            .external = lane_of<float>(block.external, k, W),
            .wrench = lane_of<float>(block.wrench, k, W),
            .pushed = one(block.pushed),
            .frozen = one(block.frozen),
            .advanced = one(block.advanced),
            .contacts = one(block.contacts),
            .penetration = one(block.penetration),
            .deepest = one(block.deepest)};
  }

  void step(int n, ThreadPool& pool) override {
    pool.for_each(num_blocks(), [&](int block, int worker) {
      step_block(blocks_[static_cast<std::size_t>(block)], workers_[static_cast<std::size_t>(worker)], n);
    });
  }

  void frame_motion(BodyId body, const Transform<float>& X_BF, ThreadPool& pool, std::span<float> pose,
                    std::span<float> velocity) override {
    pool.for_each(num_blocks(), [&](int block, int worker) {
      write_frame(static_cast<std::size_t>(block), workers_[static_cast<std::size_t>(worker)].step.dynamics, body, X_BF,
                  pose, velocity);
    });
  }

 private:
  struct Wrench {
    Force<T> normal, friction;
  };
  struct Block {
    Block(const Model& model, const System<R>& system)
        : state(model, system.contact_numbers()),
          params(model),
          external(model.links().size(), Force<T>::zero()),
          wrench(model.links().size(), {Force<T>::zero(), Force<T>::zero()}) {
      const std::vector<double> q = model.initial_configuration();
      for (std::size_t i = 0; i < q.size(); ++i) state.q()[i] = T(static_cast<R>(q[i]));
      for (const Link& link : model.links()) link_mass.push_back(T(static_cast<R>(link.inertial.mass)));
    }

    State<T> state;
    Params<T> params;
    std::vector<T> link_mass;
    std::vector<Force<T>> external;
    std::vector<Wrench> wrench;
    T pushed = T(R(0)), frozen = pushed, advanced = pushed, contacts = pushed, penetration = pushed, deepest = pushed;
  };
  /// What a worker lends to the block that it steps.
  struct Worker {
    Worker(const Model& model, const System<R>& system) : step(system), kept(numbers_before_ctrl(model), T(R(0))) {}
    static std::size_t numbers_before_ctrl(const Model& model) {
      const State<float> layout(model, 0);
      return static_cast<std::size_t>(layout.ctrl() - layout.q());
    }
    StepWorkspace<T> step;
    std::vector<T> kept;  ///< what a step changes of the state but for warm starts of contacts and loops
  };

  static T zero() { return T(R(0)); }
  static T one() { return T(R(1)); }

  void step_block(Block& block, Worker& worker, int n) {
    block.advanced = block.deepest = zero();
    for (int i = 0; i < n; ++i) {
      std::copy_n(block.state.q(), worker.kept.size(), worker.kept.begin());
      const bool pushed = any(block.pushed > zero());
      if (pushed) push(block, worker.step.dynamics);
      manyhands::step(system_, block.params, time_step_, block.state, worker.step);
      if (pushed) restore_tau(block, worker);
      freeze(block, worker);
      note_step(block, worker.step);
    }
    if (n > 0) sum_contacts(block, worker.step);
  }

  /// Adds J^T F of the forces applied to links to tau, and forgets them.
  void push(Block& block, Workspace<T>& ws) {
    const Tree<R>& tree = system_.tree;
    forward_kinematics(tree, block.state.q(), ws);
    for (std::size_t i = 0; i < links_; ++i) {
      Force<T>& F = block.external[i];
      const std::size_t body = frames_[i].body.index();
      const Vec3<T> p_OL = ws.R_WB[body] * broadcast<T>(broadcast<R>(frames_[i].X_BF.p)) + ws.p_OB[body];
      const Force<T> about_tree{F.n + cross(p_OL, F.f), F.f};
      for (int k = tree.last_dof[body]; k >= 0; k = tree.dof_parent[static_cast<std::size_t>(k)]) {
        T& tau = block.state.tau()[k];
        tau = tau + dot(ws.S[static_cast<std::size_t>(k)], about_tree);
      }
      F = Force<T>::zero();
    }
    block.pushed = zero();
  }

  void restore_tau(Block& block, const Worker& worker) {
    const auto offset = static_cast<std::size_t>(block.state.tau() - block.state.q());
    for (std::size_t i = 0; i < static_cast<std::size_t>(system_.tree.nv); ++i) {
      block.state.tau()[i] = worker.kept[offset + i];
    }
  }

  /// Worlds whose numbers have stopped being finite go back to where they were, and stay there without memory.
  void freeze(Block& block, const Worker& worker) {
    T* numbers = block.state.q();
    auto good = block.frozen == zero();
    for (std::size_t i = 0; i < static_cast<std::size_t>(system_.tree.nq + system_.tree.nv); ++i) {
      good = good & is_finite(numbers[i]);
    }
    block.advanced = block.advanced + select(good, one(), zero());
    if (all(good)) return;
    block.frozen = select(good, zero(), one());
    for (std::size_t i = 0; i < worker.kept.size(); ++i) numbers[i] = select(good, numbers[i], worker.kept[i]);
    for (T& number : block.state.equality_impulses()) number = select(good, number, zero());
    for (T& number : block.state.contact_cache()) number = select(good, number, zero());
  }

  void note_step(Block& block, const StepWorkspace<T>& ws) {
    block.penetration = zero();
    for (const ContactPoint<T>& point : ws.contact.problem.points) {
      block.penetration = max(block.penetration, select(is_finite(point.phi), -point.phi, zero()));
    }
    block.penetration = select(block.frozen > zero(), zero(), block.penetration);
    block.deepest = max(block.deepest, block.penetration);
  }

  /// What the contacts of the last step do to each link, about its origin, and how many there are.
  void sum_contacts(Block& block, const StepWorkspace<T>& ws) {
    const T inverse_h(R(1) / time_step_);
    const auto lives = block.frozen == zero();
    for (Wrench& wrench : block.wrench) wrench = {Force<T>::zero(), Force<T>::zero()};
    block.contacts = zero();
    const ContactSolver<T>& contact = ws.contact;
    for (std::size_t i = 0; i < contact.problem.points.size(); ++i) {
      const ContactPoint<T>& point = contact.problem.points[i];
      const ContactPatch<T>& patch = contact.problem.patches[point.patch];
      const Vec3<T>& impulse = contact.iterate.points[i].impulse;
      const auto touches = lives & is_finite(point.phi) & ((impulse.x > zero()) | (point.phi <= zero()));
      block.contacts = block.contacts + select(touches, one(), zero());
      const T n = inverse_h * select(touches, impulse.x, zero());
      const T y_1 = inverse_h * select(touches, impulse.y, zero());
      const T y_2 = inverse_h * select(touches, impulse.z, zero());
      const Vec3<T> normal = n * patch.normal, friction = fma(y_1, patch.e_1, y_2 * patch.e_2);
      visit_sides(patch, point, ws, [&](std::size_t link, const Vec3<T>& arm, R sign) {
        Wrench& wrench = block.wrench[link];
        wrench.normal = fma(T(sign), Force<T>{cross(arm, normal), normal}, wrench.normal);
        wrench.friction = fma(T(sign), Force<T>{cross(arm, friction), friction}, wrench.friction);
      });
    }
    for (std::size_t j = 0; j < contact.problem.torsions.size(); ++j) {
      const ContactPoint<T>& point = contact.problem.points[contact.problem.torsions[j].point];
      const ContactPatch<T>& patch = contact.problem.patches[point.patch];
      const Vec3<T> y =
          select(lives & is_finite(point.phi), inverse_h * contact.iterate.torsions[j].impulse, Vec3<T>::zero());
      const Vec3<T> moment = fma(y.x, patch.normal, fma(y.y, patch.t_1, y.z * patch.t_2));
      visit_sides(patch, point, ws, [&](std::size_t link, const Vec3<T>&, R sign) {
        Vec3<T>& sum = block.wrench[link].friction.n;
        sum = fma(T(sign), moment, sum);
      });
    }
  }

  /// Calls visit(link, the point from its origin, sign) for the links A (-1) and B (+1) of a contact point.
  template <class Visit>
  void visit_sides(const ContactPatch<T>& patch, const ContactPoint<T>& point, const StepWorkspace<T>& ws,
                   Visit&& visit) const {
    const ColliderPair& pair = system_.colliders.pairs[patch.pair];
    for (const auto& [collider, sign] : {std::pair{pair.a, R(-1)}, std::pair{pair.b, R(1)}}) {
      const std::size_t link = link_of_geom_[system_.colliders.geoms[collider].geom];
      const Frame& frame = frames_[link];
      const std::size_t b = frame.body.index();
      const Workspace<T>& d = ws.dynamics;
      const Vec3<T> p_WL = d.R_WB[b] * broadcast<T>(broadcast<R>(frame.X_BF.p)) + d.p_OB[b] + d.p_WO[b];
      visit(link, point.p - p_WL, sign);
    }
  }

  void write_frame(std::size_t index, Workspace<T>& ws, BodyId body, const Transform<float>& X_BF,
                   std::span<float> pose, std::span<float> velocity) {
    const Block& block = blocks_[index];
    for (std::size_t b = 1; b < system_.tree.bodies.size(); ++b) {
      place(system_.tree, b, block.state.q(), ws);
      move(system_.tree, b, block.state.v(), ws);
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
  std::vector<Frame> frames_;
  std::size_t links_;
  std::vector<std::size_t> link_of_geom_;
  std::vector<Block> blocks_;
  std::vector<Worker> workers_;
};

}  // namespace manyhands
