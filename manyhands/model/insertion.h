// Where the parts of one model go when another takes them in.
#pragma once

#include <span>
#include <vector>

namespace manyhands {

/// Two lists become one. Trees that a joint hangs on the world come before those that stand on a link welded to it, so
/// each list has two sections, and so has the result: old first, new first, old second, new second.
struct ListInsertion {
  int old_first{}, old_size{};  ///< length of the old list's first section, and of the whole
  int new_first{}, new_size{};

  [[nodiscard]] int of_old(int i) const { return i < old_first ? i : i + new_first; }  ///< -1 stays -1
  [[nodiscard]] int of_new(int i) const { return i < 0 ? i : (i < new_first ? old_first : old_size) + i; }
  [[nodiscard]] bool shifts() const { return new_first > 0 && old_first < old_size; }  ///< whether old items move

  /// Puts `items`, the new list, where they belong.
  template <class Item>
  void apply(std::vector<Item>& into, std::span<const Item> items) const {
    const auto first = items.begin() + new_first;
    into.insert(into.begin() + old_first, items.begin(), first);
    into.insert(into.end(), first, items.end());
  }
  template <class Item>
  void apply(std::vector<Item>& into, const std::vector<Item>& items) const {
    apply(into, std::span<const Item>(items));
  }
};

/// The indices that parts get, list by list. Those of links, joints, geoms, actuators and meshes are the old ones'
/// number more than before; the world is link and body 0 of both.
struct Insertion {
  ListInsertion bodies;  ///< the world is in the first section of the old list, and in none of the new
  ListInsertion q, v;
  ListInsertion equalities;  ///< those of mimic joints are the second section
  int links{}, joints{}, geoms{}, actuators{}, activations{}, meshes{}, height_fields{}, lifts{}, mocaps{},
      tendons{};  ///< how many there were

  [[nodiscard]] int new_body(int b) const { return b == 0 ? 0 : bodies.of_new(b - 1); }
  [[nodiscard]] int new_link(int i) const { return i <= 0 ? i : i + links - 1; }
};

}  // namespace manyhands
