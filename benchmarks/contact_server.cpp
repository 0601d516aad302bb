// Steps the scenes in contact when told to, so that peers can be timed in turns with them.
//
// First it tells where each scene's world 0 starts, a line of JSON each, then how many worlds there are in which lanes.
// To a line "scene steps" on its standard input it answers with the processor seconds that those steps took.
#include <iostream>

#include "benchmarks/contact_worlds.h"

namespace benchmarks {

namespace {

/// World 0 of a scene as a line of JSON.
void describe(ContactScene scene, const ContactStart& start) {
  const auto list = [](const auto& numbers) {
    std::string text;
    for (const double x : numbers) text += (text.empty() ? "" : ", ") + std::to_string(x);
    return "[" + text + "]";
  };
  std::string cubes;
  for (const Vec3<double>& p : start.cubes) cubes += (cubes.empty() ? "" : ", ") + list(std::array{p.x, p.y, p.z});
  std::printf("{\"name\": \"%s\", \"q\": %s, \"target\": %s, \"max_force\": %s, \"cubes\": [%s], \"yaw\": %.6f}\n",
              name_of(scene), list(start.q).c_str(), list(start.target).c_str(), list(motor_forces(scene)).c_str(),
              cubes.c_str(), start.yaw);
}

int serve() {
  std::vector<std::unique_ptr<Model>> models;
  std::vector<ContactWorlds<NativeLanes>> scenes;
  for (const ContactScene scene : kContactScenes) {
    models.push_back(std::make_unique<Model>(contact_model(cubes_of(scene))));
    const std::vector<ContactStart> starts = contact_starts(scene, *models.back());
    describe(scene, starts.front());
    scenes.emplace_back(scene, *models.back(), starts);
    for (int i = 0; i < kSettlingSteps; ++i) scenes.back().step();
  }
  std::printf("{\"worlds\": %d, \"number_type\": \"%s\"}\n", kContactWorlds, number_name<NativeLanes>());
  std::fflush(stdout);
  std::size_t scene = 0;
  long steps = 0;
  while (std::cin >> scene >> steps) {
    const double start = thread_seconds();
    for (long i = 0; i < steps; ++i) scenes.at(scene).step();
    std::printf("%.9f\n", thread_seconds() - start);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

}  // namespace benchmarks

int main(int argc, char**) {
  if (argc == 1) return benchmarks::serve();
  std::fputs("Steps scenes in contact for `python -m benchmarks`, which talks to it. Takes no arguments.\n", stderr);
  return 2;
}
