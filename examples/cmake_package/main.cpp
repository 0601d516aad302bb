// The smallest program on an installed manyhands.
#include <cstdio>

#include "manyhands/envs/env_batch.h"

int main() {
  const manyhands::EnvSpec spec{.id = "PandaReach-v3"};
  std::printf("%s\n", spec.id.c_str());
}
