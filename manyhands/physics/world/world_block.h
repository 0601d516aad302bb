// A block of worlds: W = width_v<T> worlds of one model in the lanes of one number type, and all that belongs to them.
#pragma once

#include <vector>

#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/contact_forces.h"

namespace manyhands {

/// The one list of what a block holds beside State and Params: field(name, item, one for each, range).
// clang-format off
#define MANYHANDS_BLOCK_FIELDS(field)                                                                                 \
  field(link_mass,   T,                kLink,  kNotNegative) /* [kg] */                                               \
  field(external,    Force<T>,         kLink,  kFinite)      /* on links in the next step only: external_point */     \
  field(pushed,      T,                kWorld, kFlag)        /* 1 where any of `external` may differ from 0 */        \
  field(frozen,      T,                kWorld, kFlag)        /* 1 where the world stands still */                     \
  field(wrench,      ContactForces<T>, kLink,  kResult)      /* of contacts in the last step */                       \
  field(advanced,    T,                kWorld, kResult)      /* steps that the last call of `step` took */            \
  field(touching,    T,                kWorld, kResult)      /* points that touch */                                  \
  field(penetration, T,                kWorld, kResult)      /* deepest in the last step [m] */                       \
  field(deepest,     T,                kWorld, kResult)      /* deepest in the last call of `step` [m] */             \
  field(unsettled,   T,                kWorld, kResult)      /* most in the last call: ContactSolver::unsettled */
// clang-format on

template <Number T>
struct BlockExtras {
#define MANYHANDS_FIELD(name, Item, each, range) Field<Item> name;
  MANYHANDS_BLOCK_FIELDS(MANYHANDS_FIELD)
#undef MANYHANDS_FIELD

  template <class Visit, class... Views>
  static void visit_fields(Visit&& visit, Views&... views) {
#define MANYHANDS_FIELD(name, Item, each, range) visit(FieldInfo{#name, Each::each, Range::range}, views.name...);
    MANYHANDS_BLOCK_FIELDS(MANYHANDS_FIELD)
#undef MANYHANDS_FIELD
  }
};

/// One world's BlockExtras: the numbers of a lane.
template <Real R>
struct ExtrasView {
#define MANYHANDS_FIELD(name, Item, each, range) Strided<R> name;
  MANYHANDS_BLOCK_FIELDS(MANYHANDS_FIELD)
#undef MANYHANDS_FIELD

  template <class Visit, class... Views>
  static void visit_fields(Visit&& visit, Views&... views) {
    BlockExtras<R>::visit_fields(visit, views...);
  }
};

/// All numbers of one world.
template <Real R>
struct WorldView {
  StateView<R> state;
  ParamsView<R> params;
  ExtrasView<R> extras;
};

/// What a block holds beside its worlds' state.
enum class BlockParts {
  kState,   ///< nothing: all worlds share their parameters
  kParams,  ///< parameters
  kAll,     ///< parameters, masses of links, external forces and what contacts do to links
};

/// Owns the memory of its worlds: one allocation, [field][W], laid out by the model. A contact cache that grows, that
/// of a World with many geoms, lies beside it.
template <Number T>
class WorldBlock {
 public:
  using R = real_t<T>;
  static constexpr auto W = static_cast<std::size_t>(width_v<T>);

  /// Worlds at rest in the model's initial configuration. `contact_numbers`: see System::contact_numbers.
  WorldBlock(const Model& model, std::size_t contact_numbers, BlockParts parts = BlockParts::kAll)
      : parts_(parts), state_layout_(model, contact_numbers) {
    if (parts != BlockParts::kState) params_layout_ = Layout(model);
    if (parts == BlockParts::kAll) extras_layout_ = Layout(model);
    allocate();
    state.take(model);
    if (parts != BlockParts::kState) params.take(model);
    for (std::size_t i = 0; i < extras.link_mass.size(); ++i) {
      extras.link_mass[i] = T(static_cast<R>(model.links()[i].inertial.mass));
    }
  }
  WorldBlock(const WorldBlock& other)
      : parts_(other.parts_),
        state_layout_(other.state_layout_),
        params_layout_(other.params_layout_),
        extras_layout_(other.extras_layout_),
        memory_(other.memory_),
        contact_cache_(other.contact_cache_) {
    lay_out();
  }
  WorldBlock(WorldBlock&& other) noexcept
      : parts_(other.parts_),
        state_layout_(other.state_layout_),
        params_layout_(other.params_layout_),
        extras_layout_(other.extras_layout_),
        memory_(std::move(other.memory_)),
        contact_cache_(std::move(other.contact_cache_)) {
    lay_out();
  }
  WorldBlock& operator=(WorldBlock other) noexcept {
    parts_ = other.parts_;
    state_layout_ = other.state_layout_;
    params_layout_ = other.params_layout_;
    extras_layout_ = other.extras_layout_;
    memory_.swap(other.memory_);
    contact_cache_.swap(other.contact_cache_);
    lay_out();
    return *this;
  }
  ~WorldBlock() = default;

  State<T> state;
  Params<T> params;  ///< without dofs, bodies and so on where the worlds share theirs
  BlockExtras<T> extras;

  [[nodiscard]] const Layout& state_layout() const { return state_layout_; }
  [[nodiscard]] bool has_params() const { return parts_ != BlockParts::kState; }
  [[nodiscard]] WorldView<R> view(std::size_t lane) {
    WorldView<R> result{state.view(lane), manyhands::view(params, lane), {}};
    BlockExtras<T>::visit_fields(
        [lane](const FieldInfo&, auto& field, auto& numbers) { numbers = lane_of<T>(field, lane); }, extras,
        result.extras);
    return result;
  }
  /// The same to read: nothing is written through it.
  [[nodiscard]] WorldView<R> view(std::size_t lane) const { return const_cast<WorldBlock&>(*this).view(lane); }

  /// Takes in the numbers of a part that `ModelEdit::insert` put into the model, its contact cache excepted. Memory
  /// doubles when it is full.
  void insert(const WorldBlock& part, const FieldInsertion& at) {
    const std::array<Layout*, 3> layouts{&state_layout_, &params_layout_, &extras_layout_};
    if (!std::ranges::all_of(layouts, [&](const Layout* layout) { return layout->has_room(at); })) {
      WorldBlock old(std::move(*this));
      for (Layout* layout : layouts) layout->reserve_twice(at);
      allocate();
      internal::copy_fields(old.state, state);
      internal::copy_fields(old.params, params);
      internal::copy_fields(old.extras, extras);
      contact_cache_ = std::move(old.contact_cache_);
    }
    for (Layout* layout : layouts) layout->add(at);
    lay_out();
    internal::insert_fields(at, part.state, state);
    internal::insert_fields(at, part.params, params);
    internal::insert_fields(at, part.extras, extras);
  }

  // ---- external forces -----------------------------------------------------------------------------------------
  /// Adds J^T F of the forces applied to links (whose frames `links` begins with) to tau, and forgets them. `ws` holds
  /// the bodies where they are.
  void push(const Tree<R>& tree, std::span<const Frame> links, const Workspace<T>& ws) {
    for (std::size_t i = 0; i < extras.external.size(); ++i) {
      Force<T>& F = extras.external[i];
      const std::size_t body = links[i].body.index();
      const Force<T> about_tree{F.n + cross(external_point(links[i], ws), F.f), F.f};
      for (int k = tree.last_dof[body]; k >= 0; k = tree.dof_parent[static_cast<std::size_t>(k)]) {
        T& tau = state.tau()[k];
        tau = tau + dot(ws.S[static_cast<std::size_t>(k)], about_tree);
      }
      F = Force<T>::zero();
    }
    extras.pushed[0] = T(R(0));
  }
  /// The point, from the tree's origin, about which a link's external force is given: in double the world's origin, in
  /// single precision the link's own, which loses nothing far from the world's.
  [[nodiscard]] static Vec3<T> external_point(const Frame& link, const Workspace<T>& ws) {
    const std::size_t body = link.body.index();
    if constexpr (std::same_as<R, double>) {
      return -ws.p_WO[body];
    } else {
      return ws.R_WB[body] * broadcast<T>(broadcast<R>(link.X_BF.p)) + ws.p_OB[body];
    }
  }

  // ---- a step that leads to numbers that are not finite ---------------------------------------------------------
  /// Keeps what a step changes of the state, or all of it, warm starts included.
  void keep_moved(std::vector<T>& kept) const {
    const std::span<const T> moved = state.moved_numbers();
    kept.assign(moved.begin(), moved.end());
  }
  void keep_all(std::vector<T>& kept) const {
    const std::span<const T> numbers = state.numbers();
    kept.assign(numbers.begin(), numbers.end());
    kept.insert(kept.end(), contact_cache_.begin(), contact_cache_.end());
  }
  /// Whether q and v are finite.
  [[nodiscard]] mask_t<T> is_finite() const {
    auto finite = manyhands::is_finite(T(R(0)));
    for (const T* x = state.q(); x != state.tau(); ++x) finite = finite & manyhands::is_finite(*x);
    return finite;
  }
  /// Puts the worlds that are not `good` back to what was kept; warm starts that were not are forgotten.
  void put_back(mask_t<T> good, std::span<const T> kept) {
    const std::span<T> numbers = state.numbers();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = select(good, numbers[i], i < kept.size() ? kept[i] : T(R(0)));
    }
    if (kept.size() <= numbers.size() && contact_cache_.empty()) return;
    const std::span<const T> cache = kept.subspan(numbers.size());
    state.resize_contact_cache(cache.size());
    std::ranges::copy(cache, state.contact_cache().begin());
  }
  /// Takes back what `push` added to tau.
  void restore_tau(std::span<const T> kept) {
    const auto first = static_cast<std::size_t>(state.tau() - state.q());
    std::copy(kept.begin() + static_cast<std::ptrdiff_t>(first),
              kept.begin() + static_cast<std::ptrdiff_t>(first) + (state.target_q() - state.tau()), state.tau());
  }

 private:
  void allocate() {
    memory_.assign(internal::numbers_of<T>(state_layout_, state) + internal::numbers_of<T>(params_layout_, params) +
                       internal::numbers_of<T>(extras_layout_, extras),
                   T(R(0)));
    lay_out();
  }
  void lay_out() {
    T* next = state.place(state_layout_, memory_.data(), contact_cache_);
    next = internal::place_fields(params_layout_, next, params);
    internal::place_fields(extras_layout_, next, extras);
  }

  BlockParts parts_;
  Layout state_layout_, params_layout_, extras_layout_;
  std::vector<T> memory_, contact_cache_;
};

}  // namespace manyhands
