// <tendon>.
#include <algorithm>
#include <cmath>

#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_settings.h"
#include "manyhands/model/io/mjcf/mjcf_writer.h"

namespace manyhands::io {

namespace {

/// Sites for the points, where no frame lies there already.
void write_path(MjcfWriter& writer, pugi::xml_node node, const Tendon& tendon) {
  bool first = true;
  for (const TendonBranch& branch : tendon.branches) {
    if (!first || branch.divisor != 1) set(node.append_child("pulley"), "divisor", branch.divisor);
    first = false;
    for (const TendonPoint& point : branch.points)
      set(node.append_child("site"), "site", site_at(writer, point.link, point.p_L, tendon.name + "_site"));
  }
}

void write_tendon(MjcfWriter& writer, pugi::xml_node section, const Tendon& tendon) {
  pugi::xml_node node = section.append_child(tendon.branches.empty() ? "fixed" : "spatial");
  set(node, "name", writer.names.claim("tendon", tendon.name, "tendon", writer.notes));
  if (std::isfinite(tendon.lower) || std::isfinite(tendon.upper)) {
    const auto bound = [](double x) { return std::clamp(x, -kMjcfUnlimited, kMjcfUnlimited); };
    set(node, "range", std::array{bound(tendon.lower), bound(tendon.upper)});
    write_compliance(writer, node, part("tendon", tendon.name), tendon.compliance, "solreflimit", "solimplimit");
  }
  set_unless(node, "damping", tendon.damping, 0);
  set_unless(node, "frictionloss", tendon.friction, 0);
  set_unless(node, "armature", tendon.armature, 0);
  set_unless(node, "stiffness", tendon.stiffness, 0);
  // Twice -1 would be the length at the start.
  const bool is_special = tendon.spring_lower == -1 && tendon.spring_upper == -1;
  const double lower = is_special ? std::nextafter(-1.0, -2.0) : tendon.spring_lower;
  set(node, "springlength", std::array{lower, tendon.spring_upper});
  for (const TendonJoint& part : tendon.joints) {
    pugi::xml_node joint = node.append_child("joint");
    set(joint, "joint", writer.model.joint(part.joint).name);
    set(joint, "coef", part.coefficient);
  }
  write_path(writer, node, tendon);
}

}  // namespace

double length_at_start(const MjcfWriter& writer, const Tendon& tendon) {
  double length = 0;
  for (const TendonJoint& part : tendon.joints) {
    const std::vector<double>& initial = writer.model.joint(part.joint).initial;
    length += part.coefficient * (initial.empty() ? 0 : initial[0]);
  }
  for (const TendonBranch& branch : tendon.branches) {
    for (std::size_t k = 1; k < branch.points.size(); ++k) {
      const auto at = [&](const TendonPoint& point) { return writer.place_of(point.link).X_WB * point.p_L; };
      length += norm(at(branch.points[k]) - at(branch.points[k - 1])) / branch.divisor;
    }
  }
  return length;
}

void write_tendons(MjcfWriter& writer) {
  if (writer.model.tendons().empty()) return;
  pugi::xml_node section = writer.root.append_child("tendon");
  for (const Tendon& tendon : writer.model.tendons()) write_tendon(writer, section, tendon);
}

}  // namespace manyhands::io
