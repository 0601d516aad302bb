#include "manyhands/physics/world/contact_residuals.h"

namespace manyhands {

ContactResiduals contact_residuals(const Tree<double>& tree, const StepWorkspace<double>& ws) {
  ContactResiduals largest;
  for (const ContactPoint<double>& point : ws.contacts.points) {
    const PointResiduals<double> r = point_residuals(tree, ws, point);
    largest.signorini = max(largest.signorini, r.signorini);
    largest.penetration_rate = max(largest.penetration_rate, r.penetration_rate);
    largest.cone = max(largest.cone, r.cone);
    largest.dissipation = max(largest.dissipation, r.dissipation);
  }
  return largest;
}

}  // namespace manyhands
