// Typed indices: a joint's index cannot be passed where a link's is meant.
#pragma once

#include <compare>
#include <cstddef>
#include <functional>

namespace manyhands {

/// An index into one of the arrays of a `Model`; `Tag` names the array. Default-constructed ids are invalid.
template <class Tag>
class Id {
 public:
  constexpr Id() = default;
  constexpr explicit Id(int value) : value_(value) {}
  constexpr explicit Id(std::size_t value) : value_(static_cast<int>(value)) {}

  [[nodiscard]] constexpr bool is_valid() const { return value_ >= 0; }
  [[nodiscard]] constexpr int value() const { return value_; }
  [[nodiscard]] constexpr std::size_t index() const { return static_cast<std::size_t>(value_); }

  constexpr auto operator<=>(const Id&) const = default;

 private:
  int value_ = -1;
};

using LinkId = Id<struct LinkTag>;
using JointId = Id<struct JointTag>;
using BodyId = Id<struct BodyTag>;
using FrameId = Id<struct FrameTag>;
using GeomId = Id<struct GeomTag>;
using MeshId = Id<struct MeshTag>;
using HeightFieldId = Id<struct HeightFieldTag>;
using ActuatorId = Id<struct ActuatorTag>;
using EqualityId = Id<struct EqualityTag>;
using TendonId = Id<struct TendonTag>;

}  // namespace manyhands
