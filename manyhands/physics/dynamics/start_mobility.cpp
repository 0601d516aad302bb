#include "manyhands/physics/dynamics/start_mobility.h"

#include "manyhands/base/index.h"
#include "manyhands/physics/dynamics/crba.h"
#include "manyhands/physics/dynamics/lengths.h"
#include "manyhands/physics/dynamics/ltdl.h"

namespace manyhands {

StartMobility::StartMobility(const Model& model)
    : model_(model), tree_(Tree<double>::rigid(model)), params_(model), ws_(tree_) {
  const std::vector<double> q = model.initial_configuration(), v(index(tree_.nv), 0.0);
  bias_and_mass_matrix(tree_, params_, q.data(), v.data(), ws_);
  place_lengths(tree_, q.data(), v.data(), ws_);
  for (std::size_t k = 0; k < model.tendons().size(); ++k)
    add_length_square(tree_, ws_, k, params_.tendon_armature[k], ws_.M.data(), [](std::size_t) { return 1.0; });
  L_ = ws_.M;
  factor_ltdl(tree_.dofs_from_leaves, tree_.M_parent.data(), tree_.M_row.data(), L_.data());
}

double StartMobility::respond(const std::vector<double>& J) const {
  std::vector<double> x = J;
  solve_ltdl(tree_.dofs_from_leaves, tree_.M_parent.data(), tree_.M_row.data(), L_.data(), x.data());
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += J[i] * x[i];
  return sum;
}

StartMobility::OfLink StartMobility::of_link(LinkId id) const {
  const Link& link = model_.link(id);
  const std::size_t body = link.body.index();
  const Vec3<double> p = ws_.R_WB[body] * (link.X_BL * link.inertial.com) + ws_.p_OB[body];
  std::array<std::vector<double>, 6> J;
  for (std::vector<double>& row : J) row.assign(index(tree_.nv), 0.0);
  for (const int dof : tree_.path_of(body)) {
    const std::size_t i = index(dof);
    const Motion<double> moves = at_point(ws_.S[i], p);
    const std::array<double, 6> column{moves.v.x, moves.v.y, moves.v.z, moves.w.x, moves.w.y, moves.w.z};
    for (std::size_t r = 0; r < 6; ++r) J[r][i] = column[r];
  }
  return {(respond(J[0]) + respond(J[1]) + respond(J[2])) / 3, (respond(J[3]) + respond(J[4]) + respond(J[5])) / 3};
}

double StartMobility::of_dof(std::size_t i) const {
  std::vector<double> J(index(tree_.nv), 0.0);
  J[i] = 1;
  return respond(J);
}

double StartMobility::of_tendon(TendonId tendon) const {
  std::vector<double> J(index(tree_.nv), 0.0);
  add_along_length(tree_, ws_, tendon.index(), 1.0, J.data());
  return respond(J);
}

}  // namespace manyhands
