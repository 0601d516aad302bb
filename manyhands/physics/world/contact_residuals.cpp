#include "manyhands/physics/world/contact_residuals.h"

namespace manyhands {

ContactResiduals contact_residuals(const StepWorkspace<double>& ws) {
  ContactResiduals largest;
  for (std::size_t i = 0; i < ws.contact.problem.points.size(); ++i) {
    const PointResiduals<double> r = point_residuals(ws.contact, i);
    largest.signorini = max(largest.signorini, r.signorini);
    largest.penetration_rate = max(largest.penetration_rate, r.penetration_rate);
    largest.cone = max(largest.cone, r.cone);
    largest.dissipation = max(largest.dissipation, r.dissipation);
  }
  return largest;
}

}  // namespace manyhands
