#include "manyhands/learn/privileged_input.h"

#include <stdexcept>

namespace manyhands::learn {

namespace {

/// Noise of millimetres differs by less, and matters; what does not differ at all comes out as 0.
constexpr double kLeastDeviation = 1e-6;

int dim_of(const EnvSpec& spec, const TrainerConfig& config) {
  if (!config.privileged_critic) return 0;
  if (!spec.randomized.empty()) return static_cast<int>(spec.randomized.size());
  throw std::invalid_argument(
      "privileged_critic is true, but " + spec.id +
      " randomises nothing that critics could see: make it with `randomize`, or set it to false");
}

}  // namespace

PrivilegedInput::PrivilegedInput(const EnvSpec& spec, const TrainerConfig& config)
    : normaliser_(dim_of(spec, config), 0, config.input_clip, {}, kLeastDeviation) {}

void PrivilegedInput::add(std::span<const float> values) {
  if (dim() > 0) normaliser_.add(values.data(), nullptr, nullptr);
}

void PrivilegedInput::write_below(const EnvBatch& envs, Matrix<float>& state) const {
  if (dim() == 0) return;
  for (int world = 0; world < envs.num_envs(); ++world) {
    write(envs.randomized().data() + world * dim(), state.col(world).data() + state.rows() - dim());
  }
}

void PrivilegedInput::save(ArchiveWriter& out) const {
  out.value(dim());
  normaliser_.save(out);
}

void PrivilegedInput::load(ArchiveReader& in) {
  in.expect("number of values that critics alone see", dim());
  normaliser_.load(in);
}

}  // namespace manyhands::learn
