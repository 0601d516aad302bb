// Contacts that depend on each other. In double alone.
#pragma once

#include <vector>

#include "manyhands/physics/contact/newton/newton_context.h"

namespace manyhands::internal {

/// Patches and equality constraints of trees that they join, directly or through others. No other has to do with them.
struct ContactIsland {
  std::vector<std::size_t> patches, equalities;

  /// The worst violation of the law at its patches [m/s].
  [[nodiscard]] double residual(const NewtonContext& context) const;
  /// The fastest that surfaces which overlap are asked to part [m/s].
  [[nodiscard]] double opening(const NewtonContext& context) const;
};

/// All islands of a problem, in the order of their first patches. Those without patches are left out.
class ContactIslands {
 public:
  void find(const NewtonContext& context);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const ContactIsland& operator[](std::size_t k) const { return islands_[k]; }

 private:
  int root_of(int dof);
  std::size_t island_of(const RowBlock& rows);

  std::vector<int> next_;               ///< (nv) of a cluster's first dof: another in its island, nearer to the root
  std::vector<int> number_;             ///< (nv) of a root: its island, or -1
  std::vector<ContactIsland> islands_;  ///< the first `size_` of them; the others keep their memory
  std::size_t size_ = 0;
};

}  // namespace manyhands::internal
