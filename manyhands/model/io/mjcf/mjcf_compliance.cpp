#include "manyhands/model/io/mjcf/mjcf_compliance.h"

#include <algorithm>
#include <cmath>

#include "manyhands/model/io/save/exact.h"

namespace manyhands::io {

namespace {

Compliance read_reference(const MjcfElement& e, const char* solref) {
  std::vector<double> v{0.02, 1};
  std::ranges::copy(e.numbers(solref, 1, 2), v.begin());
  if (v[0] > 0 && v[1] > 0) return compliance_of(v[0], v[1]);
  if (v[0] <= 0 && v[1] <= 0) return {.stiffness = -v[0], .damping = -v[1]};
  e.note(LoadAction::kRepaired, std::string("'") + solref + "' has numbers of both signs; MuJoCo's default taken");
  return {};
}

Compliance read_numbers(const MjcfElement& e, const char* solref, const char* solimp) {
  constexpr double kLeast = 1e-4, kMost = 1 - kLeast;  // MuJoCo's mjMINIMP and mjMAXIMP
  Compliance c = read_reference(e, solref);
  std::vector<double> v{c.impedance, c.largest_impedance, c.width, c.midpoint, c.power};
  std::ranges::copy(e.numbers(solimp, 1, 5), v.begin());
  c.impedance = std::clamp(v[0], kLeast, kMost);
  c.largest_impedance = std::clamp(v[1], kLeast, kMost);
  c.width = std::max(v[2], 0.0);
  c.midpoint = std::clamp(v[3], kLeast, kMost);
  c.power = std::max(v[4], 1.0);
  return c;
}

}  // namespace

std::optional<Compliance> read_compliance(const MjcfElement& e, MjcfCompliance taken, const char* solref,
                                          const char* solimp) {
  const Compliance c = read_numbers(e, solref, solimp);
  if (taken == MjcfCompliance::kAll || (taken == MjcfCompliance::kStated && is_soft(c))) return c;
  e.ignore({solref, solimp});
  return std::nullopt;
}

std::optional<Compliance> read_surface_compliance(const MjcfElement& e, MjcfCompliance taken) {
  Compliance c = read_numbers(e, "solref", "solimp");
  c.share = e.positive_or("solmix", 1);
  c.if_soft = taken == MjcfCompliance::kStated;
  const bool is_stated = e.has("solref") || e.has("solimp"), is_taken = taken != MjcfCompliance::kNone;
  if (!is_taken || (is_stated && !gives_way(c))) e.ignore({"solref", "solimp", "solmix"});
  return taken == MjcfCompliance::kAll || (is_taken && is_stated) ? std::optional(c) : std::nullopt;
}

void write_compliance(MjcfWriter& writer, pugi::xml_node node, const std::string& what,
                      const std::optional<Compliance>& compliance, const char* solref, const char* solimp) {
  if (!compliance) return;
  const Compliance& c = *compliance;
  std::array<double, 2> reference{-c.stiffness, -c.damping};
  if (c.stiffness > 0 && c.damping > 0) {
    const double time =
        number_for(2 / c.damping, c.damping, [](double x) { return 2 / x; }, -c.damping * c.damping / 2);
    const double ratio = c.damping / (2 * std::sqrt(c.stiffness));
    const auto read = [&](double x) { return compliance_of(time, x).stiffness; };
    const std::array<double, 2> found{time, number_for(ratio, c.stiffness, read, -2 * c.stiffness / ratio)};
    const Compliance again = compliance_of(found[0], found[1]);
    if (again.stiffness == c.stiffness && again.damping == c.damping) reference = found;
  }
  set(node, solref, reference);
  set(node, solimp, std::array{c.impedance, c.largest_impedance, c.width, c.midpoint, c.power});
  if (!is_soft(c) && !c.if_soft) {
    writer.notes.changed_alike("compliance", what,
                               "its compliance is not much softer than MuJoCo's default, and held exactly where it is "
                               "read but with compliance \"all\"");
  }
}

}  // namespace manyhands::io
