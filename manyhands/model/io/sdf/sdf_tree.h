// The trees that the joints of an SDF model make of its links, and the joints that close loops.
#pragma once

#include <string>
#include <vector>

#include "manyhands/model/io/sdf/sdf_parts.h"

namespace manyhands::io {

inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// A link and the joint on which it hangs, or kNone; both are indices in the model's lists.
struct SdfBranch {
  std::size_t link;
  std::size_t joint;
};

/// A joint between two links, by their keys, whose child hangs on another.
struct SdfLoop {
  std::size_t joint;
  std::string parent, child;
};

struct SdfTree {
  std::vector<SdfBranch> branches;  ///< depth first, children in the order of their joints in the file
  std::vector<SdfLoop> loops;
};

/// The key of the link that a joint hangs on; empty: the world. Fails if there is none.
[[nodiscard]] std::string parent_of(const SdfFrames& frames, const SdfJoint& joint);

/// Of several joints with one child, the first holds it and the others close loops. Fails on unknown names and on
/// joints that form a cycle without a root.
[[nodiscard]] SdfTree find_tree(const SdfFrames& frames, const SdfModel& model);

}  // namespace manyhands::io
