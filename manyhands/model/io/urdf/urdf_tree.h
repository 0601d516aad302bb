// The tree that the joints of a URDF make of its links.
#pragma once

#include <vector>

#include "manyhands/model/io/urdf/urdf_parts.h"

namespace manyhands::io {

/// A link with the joint to its parent; all are indices in the robot's lists.
struct UrdfBranch {
  std::size_t joint;
  std::size_t link;
  std::size_t parent;
};

struct UrdfTree {
  std::size_t root;
  std::vector<UrdfBranch> branches;  ///< depth first, children in the order of their joints in the file

  /// All links from the root on.
  [[nodiscard]] std::vector<std::size_t> depth_first() const;
};

/// Finds the tree. Fails, naming the line, on unknown links, second parents, several roots and cycles, and on mimics
/// that name no joint or drive each other in a circle.
[[nodiscard]] UrdfTree find_tree(const UrdfRobot& robot);

/// The same in the order of the links in the file, each behind its parent.
[[nodiscard]] UrdfTree in_file_order(UrdfTree tree);

}  // namespace manyhands::io
