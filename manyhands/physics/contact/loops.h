// Loops: equations between bodies or joints that always hold. They are eliminated exactly: what contacts see is the
// tree's answer to an impulse with the loops' own answer to it taken off.
#pragma once

#include <algorithm>

#include "manyhands/physics/contact/prepare_contacts.h"

namespace manyhands {

/// Three rows of one loop. Rows that the loop does not need are zero.
template <Number T>
struct LoopRows {
  RowBlock rows{};
  std::size_t loop{};
  std::size_t row{};    ///< the first of the three in the state's memory
  std::size_t first{};  ///< the first of them among those of all loops that are not zero
  [[nodiscard]] std::size_t count() const { return rows.single ? 1 : 3; }
  mask_t<T> acts{true};  ///< the worlds in which it does
  Vec3<T> offset{};      ///< J v less the velocity that closes the loop by the step's end
  Vec3<T> impulse{};     ///< [N s or N m s]
  T most{};              ///< of each component
};

/// All loops of a model: K = J A J^T = Y Y^T over all their rows, and its factors.
template <Number T>
struct LoopSet {
  explicit LoopSet(const Tree<real_t<T>>& tree)
      : store(tree.nv),
        K(tree.equality_rows * tree.equality_rows),
        pivot_inverse(tree.equality_rows),
        x(tree.equality_rows) {
    blocks.reserve(tree.equality_rows / 3);
  }

  std::vector<LoopRows<T>> blocks;
  RowStore<T> store;
  std::vector<T> K;              ///< (rows, rows) lower triangle: its factor L, K = L D L^T
  std::vector<T> pivot_inverse;  ///< (rows) 1 / D; 0 where a row says what others have said
  std::vector<T> x;              ///< (rows) scratch
  std::vector<Vec3<T>> Z;        ///< (rows of patches, rows) the loops' impulses per impulse of a contact
};

namespace internal {

/// Rows whose part of K that the others leave is smaller than this, relatively, are redundant.
template <Number T>
inline constexpr real_t<T> kRedundant = std::same_as<real_t<T>, float> ? real_t<T>(1e-4) : real_t<T>(1e-10);

/// A loop that stands open closes no faster [m/s or rad/s].
inline constexpr double kFastestClosing = 1;

/// The offset of a row whose error is e and whose rate is u: by the step's end the error shall be 0 to third order,
/// e + h u+ + h^2 / 2 gamma = 0.
template <Number T>
MANYHANDS_INLINE Vec3<T> closing_offset(const Vec3<T>& u, const Vec3<T>& e, const Vec3<T>& gamma, real_t<T> h) {
  const T most(static_cast<real_t<T>>(kFastestClosing)), inverse_h(real_t<T>(1) / h);
  const auto closing = [&](T error) { return clamp(error * inverse_h, -most, most); };
  return u + fma(T(real_t<T>(0.5) * h), gamma, Vec3<T>{closing(e.x), closing(e.y), closing(e.z)});
}

template <Number T>
MANYHANDS_INLINE Vec3<T> masked(const Vec3<T>& a, const std::array<bool, 3>& keep) {
  const T zero(real_t<T>(0));
  return {keep[0] ? a.x : zero, keep[1] ? a.y : zero, keep[2] ? a.z : zero};
}

/// The rows of a loop between two frames: in A's axes, B's origin against A, and B's rotation against A.
template <Number T>
MANYHANDS_INLINE void add_frame_rows(const Tree<real_t<T>>& tree, const Workspace<T>& ws, real_t<T> h,
                                     std::size_t index, LoopSet<T>& set) {
  const TreeEquality<real_t<T>>& loop = tree.equalities[index];
  const std::size_t a = loop.body_a, b = loop.body_b;
  const auto pose = [&](std::size_t body, const Transform<real_t<T>>& X) {
    return Transform<T>{ws.R_WB[body], ws.p_OB[body] + ws.p_WO[body]} * broadcast<T>(X);
  };
  const Transform<T> X_A = pose(a, loop.X_BA), X_B = pose(b, loop.X_BB);
  const bool slides = loop.type == EqualityType::kPrismatic || loop.type == EqualityType::kSlider;
  const bool turns_about_z = loop.type == EqualityType::kHinge || loop.type == EqualityType::kSlider;
  const std::array<bool, 3> linear{true, true, !slides}, angular{true, true, !turns_about_z};
  const auto axes = [&](const std::array<bool, 3>& keep) {
    const Vec3<T> none = Vec3<T>::zero();
    return std::array<Vec3<T>, 3>{keep[0] ? X_A.R.x : none, keep[1] ? X_A.R.y : none, keep[2] ? X_A.R.z : none};
  };
  const T most = T(h * loop.max_force);
  const RowBlock between = rows_between<T>(tree, a, b);
  {
    LoopRows<T>& block = set.blocks.emplace_back();
    block.loop = index;
    block.row = loop.row;
    block.most = most;
    block.rows = add_row_block(between, set.store);
    fill_point_rows(tree, ws, block.rows, X_B.p, axes(linear), set.store);
    const auto [u, acceleration] = relative_motion(ws, a, b, X_B.p);
    const Vec3<T> gamma = acceleration - T(real_t<T>(2)) * cross(ws.V[a].w, u);
    block.offset = masked(closing_offset(transpose_times(X_A.R, u), transpose_times(X_A.R, X_B.p - X_A.p),
                                         transpose_times(X_A.R, gamma), h),
                          linear);
  }
  if (!loop.turns) return;
  LoopRows<T>& block = set.blocks.emplace_back();
  block.loop = index;
  block.row = loop.row + 3;
  block.most = most;
  block.rows = add_row_block(between, set.store);
  fill_rotation_rows(tree, ws, block.rows, axes(angular), set.store);
  const Vec3<T> w = ws.V[b].w - ws.V[a].w;
  const Vec3<T> gamma = ws.A[b].w - ws.A[a].w - cross(ws.V[a].w, w);
  const Vec3<T> turn = turns_about_z ? transpose_times(X_A.R, cross(X_A.R.z, X_B.R.z))
                                     : rotation_vector(to_quat(transpose(X_A.R) * X_B.R));
  block.offset = masked(closing_offset(transpose_times(X_A.R, w), turn, transpose_times(X_A.R, gamma), h), angular);
}

/// A loop between joints that motors hold anyway, where they agree with it to this [rad/s or m/s], has nothing to do.
inline constexpr double kAgreement = 1e-6;

/// The row of a loop between two joints: q_b - ratio q_a - offset, or its rate alone. None if it has nothing to do in
/// any world.
template <Number T>
MANYHANDS_INLINE void add_joint_row(const Tree<real_t<T>>& tree, const State<T>& state, real_t<T> h, std::size_t index,
                                    const JointConstraints<T>& jc, LoopSet<T>& set) {
  using R = real_t<T>;
  const TreeEquality<R>& loop = tree.equalities[index];
  const T zero(R(0)), ratio(loop.ratio);
  T u = state.v()[loop.dof_b] - ratio * state.v()[loop.dof_a];
  T error = zero;
  if (loop.type == EqualityType::kJoint) error = state.q()[loop.q_b] - fma(ratio, state.q()[loop.q_a], T(loop.offset));
  const T most(static_cast<R>(kFastestClosing));
  const T offset = u + clamp(T(R(1) / h) * error, -most, most);
  const T held_apart = fma(ratio, -jc.target[loop.dof_a], jc.target[loop.dof_b]) + offset;
  const auto held = (state.stance()[loop.dof_a] == zero) & (state.stance()[loop.dof_b] == zero);
  const auto agrees = held & (abs(held_apart) < T(static_cast<R>(kAgreement)));
  const auto acts = (!agrees) | (jc.touched[loop.dof_a] > zero) | (jc.touched[loop.dof_b] > zero);
  if (none(acts)) return;
  LoopRows<T>& block = set.blocks.emplace_back();
  block.loop = index;
  block.row = loop.row;
  block.most = T(h * loop.max_force);
  block.rows = add_row_block(rows_between<T>(tree, loop.body_a, loop.body_b), set.store);
  block.rows.single = true;
  visit_rows<T>(tree, block.rows, [&](std::size_t entry, std::size_t i, R) {
    const T weight = i == loop.dof_a ? -ratio : i == loop.dof_b ? T(R(1)) : zero;
    set.store.J[entry] = {select(acts, weight, zero), zero, zero};
  });
  block.acts = acts;
  block.offset = {select(acts, offset, zero), zero, zero};
}

/// The three numbers of a block in an array over the rows of all blocks.
template <Number T>
MANYHANDS_INLINE Vec3<T> rows_of(const std::vector<T>& x, const LoopRows<T>& block) {
  const T zero(real_t<T>(0)), *own = &x[block.first];
  return block.rows.single ? Vec3<T>{own[0], zero, zero} : Vec3<T>{own[0], own[1], own[2]};
}
template <Number T>
MANYHANDS_INLINE void set_rows(std::vector<T>& x, const LoopRows<T>& block, const Vec3<T>& value) {
  T* own = &x[block.first];
  own[0] = value.x;
  if (block.rows.single) return;
  own[1] = value.y;
  own[2] = value.z;
}

/// K = L D L^T in place; a row that adds nothing to those before it gets no say.
template <Number T>
MANYHANDS_INLINE void factor_loops(LoopSet<T>& set) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), tiny(std::numeric_limits<R>::min() * R(1e6));
  const std::size_t n = set.x.size();
  for (std::size_t i = 0; i < n; ++i) {
    T* row = &set.K[i * n];
    const T whole = row[i];
    T pivot = whole;
    for (std::size_t j = 0; j < i; ++j) {
      const T* other = &set.K[j * n];
      T sum = row[j];
      for (std::size_t k = 0; k < j; ++k) sum = fma(-row[k], other[k], sum);
      row[j] = sum;  // L_ij D_j for now
    }
    for (std::size_t j = 0; j < i; ++j) {
      const T scaled = row[j] * set.pivot_inverse[j];
      pivot = fma(-scaled, row[j], pivot);
      row[j] = scaled;
    }
    const auto counts = pivot > max(T(kRedundant<T>) * whole, tiny);
    set.pivot_inverse[i] = select(counts, one / select(counts, pivot, one), zero);
  }
}

/// x := K^-1 x. X is T, or Vec3<T> for three right-hand sides at once.
template <Number T, class X>
MANYHANDS_INLINE void solve_loops(const LoopSet<T>& set, X* x) {
  const std::size_t n = set.x.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) x[i] = fma(-set.K[i * n + j], x[j], x[i]);
  for (std::size_t i = 0; i < n; ++i) x[i] = x[i] * set.pivot_inverse[i];
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t j = i + 1; j < n; ++j) x[i] = fma(-set.K[j * n + i], x[j], x[i]);
}

}  // namespace internal

/// The rows of all loops, with the impulses of the last step added to `jc.rhs`. After `prepare_contacts`.
template <Number T>
MANYHANDS_INLINE void prepare_loops(const Tree<real_t<T>>& tree, real_t<T> h, State<T>& state, const Workspace<T>& ws,
                                    JointConstraints<T>& jc, LoopSet<T>& set) {
  set.blocks.clear();
  set.store.clear();
  for (std::size_t i = 0; i < tree.equalities.size(); ++i) {
    if (tree.equalities[i].type == EqualityType::kJoint || tree.equalities[i].type == EqualityType::kGear) {
      internal::add_joint_row(tree, state, h, i, jc, set);
    } else {
      internal::add_frame_rows(tree, ws, h, i, set);
    }
  }
  set.x.clear();
  const std::span<T> memory = state.equality_impulses();
  for (LoopRows<T>& block : set.blocks) {
    block.first = set.x.size();
    set.x.resize(block.first + block.count());
    const T* old = &memory[block.row];
    block.impulse = select(block.acts, Vec3<T>{old[0], old[1], old[2]}, Vec3<T>::zero());
    internal::touch_trees(block.rows, block.acts, jc);
    add_row_impulse(tree, block.rows, set.store, block.impulse, jc.rhs.data());
  }
  for (T& number : memory) number = T(real_t<T>(0));
}

namespace internal {

/// Y of every loop, and the factors of K, for the stances whose factors are in ws.L.
template <Number T>
MANYHANDS_INLINE void find_loop_answers(const Tree<real_t<T>>& tree, const Workspace<T>& ws, LoopSet<T>& set) {
  const std::size_t n = set.x.size();
  for (std::size_t j = 0; j < set.blocks.size(); ++j) {
    const LoopRows<T>& block = set.blocks[j];
    find_answer(tree, block.rows, ws, set.store);
    keep_answer(block.rows, set.store);
    for (std::size_t i = 0; i <= j; ++i) {
      const LoopRows<T>& other = set.blocks[i];
      const std::array<Vec3<T>, 3> K = multiply_answers(other.rows, set.store, block.rows, set.store.x);
      for (std::size_t r = 0; r < other.count(); ++r) {
        const std::array<T, 3> column{K[r].x, K[r].y, K[r].z};
        for (std::size_t k = i < j ? 0 : r; k < block.count(); ++k)
          set.K[(block.first + k) * n + other.first + r] = column[k];
      }
    }
  }
  factor_loops(set);
}

/// Closes the loops at the present dv: their impulses change, and dv with them.
template <Number T>
MANYHANDS_INLINE void close_loops(const Tree<real_t<T>>& tree, const Workspace<T>& ws, mask_t<T> active,
                                  LoopSet<T>& set, JointConstraints<T>& jc) {
  if (set.blocks.empty()) return;
  for (const LoopRows<T>& block : set.blocks) {
    set_rows(set.x, block, -(block.offset + multiply_rows(tree, block.rows, set.store, jc.dv.data())));
  }
  solve_loops(set, set.x.data());
  begin_change(set.store);
  for (LoopRows<T>& block : set.blocks) {
    const Vec3<T> total = block.impulse + rows_of(set.x, block);
    const Vec3<T> limited{clamp(total.x, -block.most, block.most), clamp(total.y, -block.most, block.most),
                          clamp(total.z, -block.most, block.most)};
    const Vec3<T> next = select(active, limited, block.impulse);
    apply_row_impulse(block.rows, next - block.impulse, set.store);
    block.impulse = next;
  }
  end_change(tree, ws, set.store, jc);
}

/// Takes the loops' answer to a contact's impulse off its Y in store.x; Z (loop rows) keeps that answer. Right after
/// `find_answer` for the contact.
template <Number T>
MANYHANDS_INLINE void eliminate_loops(const RowBlock& rows, const LoopSet<T>& loops, Vec3<T>* Z, RowStore<T>& store) {
  for (const LoopRows<T>& loop : loops.blocks) {
    const std::array<Vec3<T>, 3> H = multiply_answers(loop.rows, loops.store, rows, store.x);
    std::copy_n(H.begin(), loop.count(), Z + loop.first);
  }
  solve_loops(loops, Z);
  for (const LoopRows<T>& loop : loops.blocks) {
    const Vec3<T>* own = Z + loop.first;
    visit_answer(loop.rows, [&](std::size_t entry, std::size_t dof) {
      const Vec3<T>& Y = loops.store.Y[entry];
      Vec3<T>& x = store.x[dof];
      x = fma(-Y.x, own[0], x);
      if (!loop.rows.single) x = fma(-Y.y, own[1], fma(-Y.z, own[2], x));
    });
  }
}

/// Writes the loops' impulses down for the next step.
template <Number T>
MANYHANDS_INLINE void remember_loops(const LoopSet<T>& loops, std::span<T> memory) {
  for (const LoopRows<T>& block : loops.blocks) {
    memory[block.row] = block.impulse.x;
    memory[block.row + 1] = block.impulse.y;
    memory[block.row + 2] = block.impulse.z;
  }
}

/// What a change of a contact's impulse changes in the loops'.
template <Number T>
MANYHANDS_INLINE void follow_contact(const Vec3<T>* Z, const Vec3<T>& change, LoopSet<T>& loops) {
  for (LoopRows<T>& loop : loops.blocks) {
    const Vec3<T>* own = Z + loop.first;
    loop.impulse.x -= dot(own[0], change);
    if (loop.rows.single) continue;
    loop.impulse.y -= dot(own[1], change);
    loop.impulse.z -= dot(own[2], change);
  }
}

}  // namespace internal

}  // namespace manyhands
