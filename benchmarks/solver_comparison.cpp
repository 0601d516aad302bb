// Compares families of contact solvers on one step's problem: how many iterations and how much time they need until the
// law of contact is obeyed to 1e-3, 1e-6 and 1e-9, from nothing and from the solution of the step before.
//
// The solvers are those of tests/physics/contact/reference, in double. docs/contact_solver.md explains the table.
#include "benchmarks/support.h"
#include "tests/physics/contact/reference/admm.h"
#include "tests/physics/contact/reference/newton.h"
#include "tests/physics/contact/reference/scenes.h"

namespace benchmarks {

namespace {

using namespace manyhands::testing;

constexpr std::array kTolerances{1e-3, 1e-6, 1e-9};  // of the residual, relative to the problem's scale
constexpr double kForces = 0.01, kMotion = 0;        // how much two steps differ
constexpr double kUneven = 0.001;                    // by how much contacts may have opened in between

/// Where one run reached each tolerance, without the time that looking took.
struct Course {
  std::array<int, 3> iterations{};  ///< 0: never
  std::array<double, 3> seconds{};
  ContactResiduals last;
};

/// A solver: runs from impulses and tells the observer every iterate.
using Solver = std::function<void(const ReferenceProblem&, const Eigen::VectorXd& start, const Observer&)>;

struct Method {
  std::string name;
  Solver solve;
};

struct Scene {
  std::string name;
  ReferenceProblem problem;
};

Course follow(const Solver& solve, const ReferenceProblem& problem, const Eigen::VectorXd& start) {
  Course course;
  int iterations = 0;
  double looking = 0;
  const double begin = thread_seconds();
  solve(problem, start, [&](const ReferenceSolution& x) {
    const double now = thread_seconds();
    ++iterations;
    course.last = residuals(problem, x);
    const double error = course.last.law / problem.scale;
    for (std::size_t i = 0; i < kTolerances.size(); ++i) {
      if (error > kTolerances[i] || course.iterations[i] > 0) continue;
      course.iterations[i] = iterations;
      course.seconds[i] = now - begin - looking;
    }
    looking += thread_seconds() - now;
    return error > kTolerances.back();
  });
  return course;
}

Method gauss_seidel(std::string name, GaussSeidelOptions options) {
  return {std::move(name), [options](const ReferenceProblem& problem, const Eigen::VectorXd& start,
                                     const Observer& observe) { GaussSeidel(problem).solve(start, options, observe); }};
}

std::vector<Method> methods(int sweeps) {
  const auto accelerated = [&](Acceleration acceleration, int depth = 0) {
    return GaussSeidelOptions{.max_sweeps = sweeps, .acceleration = acceleration, .depth = depth};
  };
  return {
      gauss_seidel("NSGS", {.max_sweeps = sweeps}),
      gauss_seidel("NSGS to and fro", {.max_sweeps = sweeps, .symmetric = true}),
      gauss_seidel("NSGS over-relaxed 1.3", {.max_sweeps = sweeps, .relaxation = 1.3}),
      gauss_seidel("NSGS, conjugate", accelerated(Acceleration::kConjugate)),
      gauss_seidel("NSGS, Nesterov", accelerated(Acceleration::kNesterov)),
      gauss_seidel("NSGS, Anderson 2", accelerated(Acceleration::kAnderson, 2)),
      gauss_seidel("NSGS, Anderson 5", accelerated(Acceleration::kAnderson, 5)),
      gauss_seidel("NSGS, Anderson 15", accelerated(Acceleration::kAnderson, 15)),
      {"ADMM",
       [sweeps](const ReferenceProblem& problem, const Eigen::VectorXd& start, const Observer& observe) {
         Admm(problem).solve(problem.solution_of(start), {.max_iterations = sweeps}, observe);
       }},
      {"NSGS + Newton", [](const ReferenceProblem& problem, const Eigen::VectorXd& start,
                           const Observer& observe) { Newton(problem).solve(start, {}, observe); }},
  };
}

std::vector<Scene> scenes(bool quick) {
  std::vector<double> topped(10, 1.0);
  topped.back() = 100;
  std::vector<Scene> all{
      {"random, 3 contacts", random_problem(1, 12, 3, 10, 0.5)},
      {"box at rest", box_on_ground({0, 0, 0}, {0, 0, 0})},
      {"box sliding", box_on_ground({1, 0.3, 0}, {0, 0, 0})},
      {"box spinning", box_on_ground({0.1, 0, 0}, {0, 0, 5})},
      {"grasp, slides", slide_grasp()},
      {"grasp, hinges", hinge_grasp()},
      {"peg jam, mu 1.5", peg_jam()},
      {"tower of 5", tower(std::vector<double>(5, 1.0))},
      {"tower of 10", tower(std::vector<double>(10, 1.0))},
      {"tower of 20", tower(std::vector<double>(20, 1.0))},
      {"100 kg on 1 kg", tower({1, 100})},
      {"100 kg on 9 x 1 kg", tower(topped)},
      {"dense M, ratio 1e4", random_problem(2, 18, 5, 1e4, 0.7)},
      {"the same, redundant", random_problem(3, 12, 8, 1e4, 0.7)},
      {"arch of 9", arch(9)},
  };
  if (!quick) {
    all.push_back({"wall 10 x 10", brick_wall(10, 10)});
    all.push_back({"216 spheres", sphere_pile(6)});
  }
  return all;
}

std::string cell(const Course& course) {
  std::string text;
  for (const int n : course.iterations) text += (text.empty() ? "" : " / ") + (n > 0 ? std::to_string(n) : "-");
  return text;
}

/// Milliseconds to 1e-6, or nothing.
std::string milliseconds(const Course& course) {
  char text[32] = "-";
  if (course.iterations[1] > 0) std::snprintf(text, sizeof text, "%.3g", 1e3 * course.seconds[1]);
  return text;
}

void run(bool quick, const std::string& only) {
  for (const auto& [name, problem] : scenes(quick)) {
    if (name.find(only) == std::string::npos) continue;
    std::printf("\n%s: nv %d, %d contacts, scale %.3g m/s\n", name.c_str(), problem.nv(), problem.contacts(),
                problem.scale);
    std::printf("| %-22s | %-20s | %-20s | %-20s | %-8s | %-8s | %-7s | %-7s | %-7s | %-7s | %-7s |\n", "method",
                "cold 1e-3/1e-6/1e-9", "warm", "warm, uneven", "cold ms", "warm ms", "law", "Signor.", "cone",
                "dissip.", "self");
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(3 * problem.contacts());
    const ReferenceProblem next = next_step(problem, kForces, kMotion, 0, 7),
                           uneven = next_step(problem, kForces, kMotion, kUneven, 7);
    Eigen::VectorXd before = nothing;
    Newton(problem).solve(nothing, {}, [&, p = &problem](const ReferenceSolution& x) {
      before = x.lambda;
      return residuals(*p, x).law > kTolerances.back() * p->scale;
    });
    for (const Method& method : methods(problem.contacts() > 200 ? 1000 : 3000)) {
      const Course cold = follow(method.solve, problem, nothing), warm = follow(method.solve, next, before),
                   rough = follow(method.solve, uneven, before);
      const ContactResiduals& r = cold.last;
      std::printf("| %-22s | %-20s | %-20s | %-20s | %-8s | %-8s | %.1e | %.1e | %.1e | %.1e | %.1e |\n",
                  method.name.c_str(), cell(cold).c_str(), cell(warm).c_str(), cell(rough).c_str(),
                  milliseconds(cold).c_str(), milliseconds(warm).c_str(), r.law, r.signorini, r.cone, r.dissipation,
                  r.consistency);
      std::fflush(stdout);
    }
  }
}

}  // namespace

}  // namespace benchmarks

int main(int argc, char** argv) {
  bool quick = false;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else if (argv[i][0] != '-') {
      only = argv[i];
    } else {
      const bool help = std::strcmp(argv[i], "--help") == 0;
      std::fprintf(help ? stdout : stderr,
                   "Compares contact solvers.\nUsage: %s [--quick] [part of a scene's name]\n"
                   "Iterations (sweeps) and milliseconds (to 1e-6) until the law is obeyed, and the last residuals.\n",
                   argv[0]);
      return help ? 0 : 2;
    }
  }
  benchmarks::run(quick, only);
}
