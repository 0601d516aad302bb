// How long a running world takes to gain and lose bodies, with a question about each: build/release/benchmarks/edits
// [n]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

using Question = std::function<void(const World&, const std::string&)>;

double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

NewBody box(const std::string& name, int i) {
  return {.name = name,
          .shape = {.type = ShapeType::kBox, .size = {0.02, 0.02, 0.02}},
          .mass = 0.1,
          .X_WB = {Mat3<double>::identity(), {0.1 * (i % 100), 0.1 * (i / 100), 0.02}}};
}

void measure(const char* label, int n, const Question& ask) {
  World world;
  world.add_body({.name = "floor", .shape = {.type = ShapeType::kPlane}, .fixed = true});
  std::vector<std::string> names;
  for (int i = 0; i < n; ++i) names.push_back("box" + std::to_string(i));
  const double start = seconds();
  for (int i = 0; i < n; ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    world.add_body(box(name, i));
    ask(world, name);
  }
  const double added = seconds();
  world.step();
  const double stepped = seconds();
  world.step(5);
  const double ran = seconds();
  std::ranges::shuffle(names, std::mt19937(1));
  world.add_body(box("last", n));
  for (const std::string& name : names) {
    world.remove(name);
    ask(world, "last");
  }
  std::printf("%-14s add %5d: %7.3f s   remove: %7.3f s   first step: %6.3f s   others: %6.3f s\n", label, n,
              added - start, seconds() - ran, stepped - added, (ran - stepped) / 5);
  std::fflush(stdout);
}

}  // namespace
}  // namespace manyhands

int main(int argc, char** argv) {
  using namespace manyhands;
  const int n = argc > 1 ? std::atoi(argv[1]) : 10000;
  const Vec3<double> origin{0.01, 0.01, 1}, down{0, 0, -1};
  measure("body_pose", n, [](const World& w, const std::string& name) { (void)w.body_pose(name); });
  measure("mass", n, [](const World& w, const std::string& name) { (void)w.mass(name); });
  measure("q, v", n, [](const World& w, const std::string&) { (void)(w.q().size() + w.v().size()); });
  measure("contacts", n, [](const World& w, const std::string&) { (void)w.contacts(); });
  measure("ray_cast", n, [&](const World& w, const std::string&) { (void)w.ray_cast({&origin, 1}, {&down, 1}, 5); });
  measure("near_links(of)", n, [](const World& w, const std::string& name) { (void)w.near_links(0.01, name); });
  measure("near_links", std::min(n, 300), [](const World& w, const std::string&) { (void)w.near_links(0.01); });
  return 0;
}
