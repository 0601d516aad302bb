// World as bytes.
#include <concepts>

#include "manyhands/base/bytes.h"
#include "manyhands/model/model_archive.h"
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

template <class Archive, class T>
  requires std::same_as<std::remove_const_t<T>, LoadNote>
void visit_fields(Archive& archive, T& note) {
  auto& [action, file, line, element, message, serious] = note;
  archive(action, file, line, element, message, serious);
}

std::vector<std::uint8_t> World::archived() const {
  ByteWriter out;
  out(manyhands::archived(model()), time_step_, integrator_, since_, *solver_, report_.notes, snapshot());
  return out.finish();
}

World World::unarchived(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  std::vector<std::uint8_t> model, snapshot;
  double time_step = 0, since = 0;
  Integrator integrator{};
  SolverSettings solver;
  LoadReport report;
  in(model, time_step, integrator, since, solver, report.notes, snapshot);
  World world(std::make_shared<const Model>(manyhands::unarchived(model)), time_step, integrator);
  world.set_solver(solver);
  world.since_ = since;
  world.report_ = std::move(report);
  world.restore(snapshot);
  return world;
}

}  // namespace manyhands
