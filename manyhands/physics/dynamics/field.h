// Flat memory with named fields: what there is one item for each of, where it lies, and what its numbers may be.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "manyhands/base/assert.h"
#include "manyhands/math/number.h"
#include "manyhands/model/insertion.h"

namespace manyhands {

class Model;

/// What a field has an item for each of.
enum class Each : std::uint8_t {
  kWorld,
  kCoordinate,     ///< of q
  kDof,            ///< of v
  kActuator,       ///<
  kEqualityRow,    ///< three for every equality constraint, six where it holds rotations
  kContactNumber,  ///< of the contact cache
  kBody,           ///< the world included
  kGeom,           ///<
  kLink,           ///< the world included
  kLift,           ///< see Model::lifts
  kMocapNumber,    ///< seven for every body that a user moves: x y z, quaternion xyzw
  kTendon,         ///<
  kActivation,     ///< of actuators that have one
};
inline constexpr std::size_t kKindsOfEach = 13;

/// What the numbers of a field may be; a snapshot with others is refused.
enum class Range : std::uint8_t {
  kFinite,
  kNotNegative,  ///< finite, 0 or more
  kForceLimit,   ///< 0 or more, infinity included
  kLimit,        ///< any but NaN
  kFlag,         ///< 0 or 1
  kResult,       ///< what the last step found: no part of a snapshot
};

struct FieldInfo {
  const char* name;
  Each each;
  Range range;
};

/// Where the items of fields go when they take in others; by what there is one for each of.
using FieldInsertion = std::array<ListInsertion, kKindsOfEach>;

/// How many there are of what fields have items for: with the lists of fields it says where every field lies.
class Layout {
 public:
  Layout() = default;  ///< none of anything, and one world
  /// `contact_numbers`: how many numbers the contact cache takes, which System::contact_numbers tells.
  explicit Layout(const Model& model, std::size_t contact_numbers = 0);

  [[nodiscard]] std::size_t operator[](Each each) const { return counts_[static_cast<std::size_t>(each)]; }
  [[nodiscard]] std::size_t& operator[](Each each) { return counts_[static_cast<std::size_t>(each)]; }

  /// For how many there is memory: as many as there are, unless more was reserved.
  [[nodiscard]] std::size_t room(Each each) const {
    return std::max((*this)[each], rooms_[static_cast<std::size_t>(each)]);
  }
  [[nodiscard]] bool has_room(const FieldInsertion& at) const;
  /// For twice as many as there will be, where there is no room.
  void reserve_twice(const FieldInsertion& at);
  void add(const FieldInsertion& at);

 private:
  std::array<std::size_t, kKindsOfEach> counts_{1}, rooms_{};
};

/// A run of items in flat memory that somebody else owns; const as what holds it is.
template <class Item>
class Field {
 public:
  Field() = default;
  Field(Item* first, std::size_t size) : first_(first), size_(size) {}

  [[nodiscard]] MANYHANDS_INLINE Item& operator[](std::size_t i) {
    MANYHANDS_ASSERT(i < size_);
    return first_[i];
  }
  [[nodiscard]] MANYHANDS_INLINE const Item& operator[](std::size_t i) const {
    MANYHANDS_ASSERT(i < size_);
    return first_[i];
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] Item* data() { return first_; }
  [[nodiscard]] const Item* data() const { return first_; }
  [[nodiscard]] Item* begin() { return first_; }
  [[nodiscard]] Item* end() { return first_ + size_; }
  [[nodiscard]] const Item* begin() const { return first_; }
  [[nodiscard]] const Item* end() const { return first_ + size_; }

 private:
  Item* first_ = nullptr;
  std::size_t size_ = 0;
};

/// Numbers of one world that lie `stride` apart: those of one lane.
template <Real R>
struct Strided {
  R* first = nullptr;
  std::size_t stride = 1, count = 0;

  [[nodiscard]] std::size_t size() const { return count; }
  [[nodiscard]] R& operator[](std::size_t i) const {
    MANYHANDS_ASSERT(i < count);
    return first[i * stride];
  }
};

/// One lane of a field, whose items are numbers or structs of numbers.
template <Number T, class Item>
[[nodiscard]] Strided<real_t<T>> lane_of(Field<Item>& field, std::size_t lane) {
  static_assert(sizeof(Item) % sizeof(T) == 0);
  using R = real_t<T>;
  if (field.empty()) return {};
  return {reinterpret_cast<R*>(field.data()) + lane, static_cast<std::size_t>(width_v<T>),
          field.size() * (sizeof(Item) / sizeof(T))};
}

namespace internal {

/// How many numbers of type T the fields take under the layout. `Fields` is one of the structs with a list of fields.
template <Number T, class Fields>
[[nodiscard]] std::size_t numbers_of(const Layout& layout, Fields& fields) {
  std::size_t count = 0;
  Fields::visit_fields(
      [&]<class Item>(const FieldInfo& info, const Field<Item>&) {
        count += layout.room(info.each) * (sizeof(Item) / sizeof(T));
      },
      fields);
  return count;
}

/// Lets the fields lie one after the other from `memory` on, and returns where they end.
template <Number T, class Fields>
T* place_fields(const Layout& layout, T* memory, Fields& fields) {
  Fields::visit_fields(
      [&]<class Item>(const FieldInfo& info, Field<Item>& field) {
        field = {reinterpret_cast<Item*>(memory), layout[info.each]};
        memory += layout.room(info.each) * (sizeof(Item) / sizeof(T));
      },
      fields);
  return memory;
}

/// Copies every field but the contact cache, which does not lie with the others.
template <class Fields>
void copy_fields(const Fields& from, Fields& to) {
  Fields::visit_fields(
      [](const FieldInfo& info, const auto& a, auto& b) {
        if (info.each != Each::kContactNumber) std::copy(a.begin(), a.end(), b.begin());
      },
      from, to);
}

/// Puts the items of `part` among those of `into`, whose fields are as long as both together. The part's fields may
/// begin with items that do not come along: those of its world.
template <class Fields>
void insert_fields(const FieldInsertion& at, const Fields& part, Fields& into) {
  Fields::visit_fields(
      [&](const FieldInfo& info, const auto& items, auto& field) {
        const ListInsertion& list = at[static_cast<std::size_t>(info.each)];
        if (list.new_size == 0) return;
        auto* const first = field.begin();
        std::copy_backward(first + list.old_first, first + list.old_size, first + list.old_size + list.new_first);
        const auto* const split = items.end() - (list.new_size - list.new_first);
        std::copy(split - list.new_first, split, first + list.old_first);
        std::copy(split, items.end(), first + list.old_size + list.new_first);
      },
      part, into);
}

}  // namespace internal

}  // namespace manyhands
