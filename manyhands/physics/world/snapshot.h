// Snapshots of worlds as bytes: one format for World, Batch and environments.
//
//   offset  size  what
//        0     8  magic: "mhands\r\n"
//        8     4  version of the format
//       12     4  t, the length of the text
//       16     8  fingerprint of what fixes the meaning of the numbers: the model, the time step and so on
//       24     8  check sum of all other bytes
//       32     t  text: what it is a snapshot of, for people
//   32 + t        numbers of the worlds, little endian
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "manyhands/physics/world/world_block.h"

namespace manyhands {

/// What a snapshot is of.
struct SnapshotOwner {
  std::string text;  ///< as in "a World of 'panda' (12 links, nq 9, nv 9), time_step 0.002"
  std::uint64_t fingerprint;
};

/// "kind of 'name' (links, nq, nv)", and the fingerprint of the model and the time step.
[[nodiscard]] SnapshotOwner snapshot_owner(const std::string& kind, const Model& model, double time_step);

class SnapshotWriter {  ///< writes a snapshot, its owner first
 public:
  explicit SnapshotWriter(const SnapshotOwner& owner);

  template <class Number>
    requires std::is_trivially_copyable_v<Number>
  void put(const Number& number) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(&number);
    bytes_.insert(bytes_.end(), first, first + sizeof(number));
  }
  void put_bytes(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  /// Every field but results. `View`: StateView, ParamsView or ExtrasView.
  template <class View>
  void put_fields(const View& view);
  template <Real R>
  void put_world(const WorldView<R>& world) {
    put_fields(world.state);
    put_fields(world.params);
    put_fields(world.extras);
  }

  /// The snapshot; the writer is empty then.
  [[nodiscard]] std::vector<std::uint8_t> finish();

 private:
  std::vector<std::uint8_t> bytes_;
};

class SnapshotReader {
 public:
  /// Throws std::invalid_argument, in one line, if the bytes are no snapshot, damaged, of another version or of
  /// anything but `owner`.
  SnapshotReader(std::span<const std::uint8_t> snapshot, const SnapshotOwner& owner);

  /// Throws std::invalid_argument if the bytes end before.
  template <class Number>
    requires std::is_trivially_copyable_v<Number>
  Number take() {
    Number number;
    std::memcpy(&number, take_bytes(sizeof(number)).data(), sizeof(number));
    return number;
  }
  /// A whole number from 0 to `most`. Throws std::invalid_argument on another.
  [[nodiscard]] std::int64_t take_count(const char* what, std::int64_t most);
  /// Throws std::invalid_argument on a number that is out of its field's range.
  template <class View>
  void take_fields(const View& view);
  template <Real R>
  void take_world(const WorldView<R>& world) {
    take_fields(world.state);
    take_fields(world.params);
    take_fields(world.extras);
  }
  /// Throws std::invalid_argument if the bytes end before.
  [[nodiscard]] std::span<const std::uint8_t> take_bytes(std::size_t count);
  [[nodiscard]] std::size_t left() const { return rest_.size(); }
  /// Throws std::invalid_argument if bytes are left.
  void finish() const;

 private:
  std::span<const std::uint8_t> rest_;
};

/// The most steps that a clock may have counted: all numbers up to there are exact in double.
inline constexpr std::int64_t kMostSteps = std::int64_t{1} << 53;

/// What a field's range cannot say: throws std::invalid_argument unless quaternions have unit length.
template <Real R>
void require_sound(const Model& model, const StateView<R>& state);
/// The same, and unless masses are above 0 where the model's are, and inertias and sizes can be.
template <Real R>
void require_sound(const Model& model, const WorldView<R>& world);

/// The contact cache of a world whose pairs are listed: throws std::invalid_argument if it cannot be one.
template <Real R>
void require_listed_contacts(const StateView<R>& state);
/// Of a world with `geoms` colliding geoms, whose cache holds what touches: sorted keys of their pairs.
void require_found_contacts(const StateView<double>& state, std::size_t geoms);

class Hash;
/// Adds every field but results.
template <class View>
void add_fields(const View& view, Hash& hash);
template <Real R>
void add_world(const WorldView<R>& world, Hash& hash) {
  add_fields(world.state, hash);
  add_fields(world.params, hash);
  add_fields(world.extras, hash);
}

}  // namespace manyhands
