// Batch as bytes.
#include "manyhands/base/bytes.h"
#include "manyhands/model/model_archive.h"
#include "manyhands/physics/world/batch_impl.h"

namespace manyhands {

std::vector<std::uint8_t> Batch::archived() const {
  ByteWriter out;
  out(manyhands::archived(model()), num_worlds(), time_step(), num_threads(), lanes() == 1, solver(), snapshot());
  return out.finish();
}

Batch Batch::unarchived(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  std::vector<std::uint8_t> model, snapshot;
  int num_worlds = 0, num_threads = 0;
  double time_step = 0;
  bool is_scalar = false;
  SolverSettings solver;
  in(model, num_worlds, time_step, num_threads, is_scalar, solver, snapshot);
  Batch batch(std::make_shared<const Model>(manyhands::unarchived(model)), num_worlds, time_step,
              {.num_threads = num_threads, .lanes = is_scalar ? 1 : 0});
  batch.set_solver(solver);
  batch.restore(snapshot);
  return batch;
}

}  // namespace manyhands
