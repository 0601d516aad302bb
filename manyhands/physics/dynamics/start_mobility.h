// What unit forces do at a model's start: the scale on which constraints give way.
#pragma once

#include "manyhands/physics/dynamics/params.h"
#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands {

/// Diagonals of J M^-1 J^T at the model's initial configuration, by which MuJoCo scales soft constraints: mjModel's
/// body_invweight0, dof_invweight0 and tendon_invweight0. Work grows with the number of parts that are asked for.
class StartMobility {
 public:
  explicit StartMobility(const Model& model);

  struct OfLink {
    double linear{};   ///< of its centre of mass, mean of three directions [1/kg]
    double angular{};  ///< likewise [1/(kg m^2)]
  };
  [[nodiscard]] OfLink of_link(LinkId link) const;  ///< 0 of what no joint moves
  [[nodiscard]] double of_dof(std::size_t i) const;
  [[nodiscard]] double of_tendon(TendonId tendon) const;

 private:
  /// J M^-1 J^T for J (nv).
  [[nodiscard]] double respond(const std::vector<double>& J) const;

  const Model& model_;
  Tree<double> tree_;
  ParamsStorage<double> params_;
  Workspace<double> ws_;
  std::vector<double> L_;  ///< factors of M
};

}  // namespace manyhands
