// <link>: its mass, and the surface that all its shapes have.
#include <algorithm>
#include <cstdint>

#include "manyhands/model/io/inertia_repair.h"
#include "manyhands/model/io/sdf/sdf_parts.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

constexpr SymMat3<double> kUnitInertia{1, 1, 1, 0, 0, 0};  // the format's own default

Inertial read_inertial(const SdfElement& link, bool bullet) {
  const SdfElement inertial = link.child("inertial");
  if (!inertial && bullet && link.name() == "world") return {};
  if (!inertial) {
    link.note(LoadAction::kDefaulted, "no <inertial>; a mass of 1 kg and moments of inertia of 1 kg m^2 taken");
    return {.mass = 1, .inertia = kUnitInertia};
  }
  inertial.expect({"pose", "mass", "inertia"});
  SymMat3<double> I = kUnitInertia;
  if (const SdfElement inertia = inertial.child("inertia")) {
    inertia.expect({"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
    I = {inertia.number_or("ixx", 1), inertia.number_or("iyy", 1), inertia.number_or("izz", 1),
         inertia.number_or("ixy", 0), inertia.number_or("ixz", 0), inertia.number_or("iyz", 0)};
  }
  const Transform<double> X_LC = inertial.pose().X;
  Inertial result{inertial.number_or("mass", 1), X_LC.p, rotated(X_LC.R, I)};
  if (result.mass == 0) return {.com = X_LC.p};  // a fixed base, as Bullet's files write it
  const bool is_negative = result.mass < 0;
  if (const auto repair = repair_inertial(result)) {
    is_negative ? inertial.note_serious(LoadAction::kRepaired, *repair) : inertial.note(LoadAction::kRepaired, *repair);
  }
  return result;
}

/// Bullet's <contact>, for all shapes of the link.
void read_contact(const SdfElement& contact, SurfaceMaterial& surface) {
  contact.expect({"lateral_friction", "spinning_friction", "rolling_friction", "restitution", "stiffness", "damping"});
  surface.lateral_friction = contact.positive_or("lateral_friction", surface.lateral_friction);
  surface.spinning_friction = contact.positive_or("spinning_friction", surface.spinning_friction);
  surface.rolling_friction = contact.positive_or("rolling_friction", surface.rolling_friction);
  surface.restitution = contact.restitution_or("restitution", surface.restitution);
  if (contact.has("stiffness")) surface.stiffness = contact.positive_or("stiffness", 0);
  if (contact.has("damping")) surface.damping = contact.positive_or("damping", 0);
}

/// Two geoms touch if their bit masks have a bit in common.
CollisionFilter read_filter(const SdfElement& collision) {
  constexpr std::uint32_t kAll = 0xffff;
  const SdfElement surface = collision.child("surface");
  const SdfElement contact = surface ? surface.child("contact") : surface;
  const SdfElement mask = contact ? contact.child("collide_bitmask") : contact;
  if (!mask) return {kAll, kAll};
  const std::string text = mask.text();
  const bool is_hex = text.starts_with("0x") || text.starts_with("0X");
  const std::string digits = is_hex ? text.substr(2) : text;
  constexpr std::size_t kMostDigits = 9;
  const char* const known = is_hex ? "0123456789abcdefABCDEF" : "0123456789";
  if (digits.empty() || digits.size() > kMostDigits || digits.find_first_not_of(known) != digits.npos) {
    mask.fail("<collide_bitmask> holds " + in_quotes(text) + "; expected a number such as 0x01");
  }
  const auto bits = static_cast<std::uint32_t>(std::stoull(digits, nullptr, is_hex ? 16 : 10));
  return {bits, bits};
}

}  // namespace

SdfLink read_link(const SdfElement& link, const SdfOptions& options, bool masks) {
  link.expect({"pose", "inertial", "collision", "visual", "contact", "gravity", "self_collide"});
  SdfLink result{
      .source = link, .name = link.name(), .scope = {}, .key = {}, .inertial = read_inertial(link, options.bullet)};
  if (!link.flag_or("gravity", true)) result.gravity_compensation = 1;
  for (const SdfElement& element : link.children("visual")) {
    if (std::optional<SdfGeom> geom = read_geom(element, GeomRole::kVisual)) result.geoms.push_back(std::move(*geom));
  }
  const SdfElement contact = link.child("contact");
  for (const SdfElement& element : link.children("collision")) {
    std::optional<SdfGeom> geom = read_geom(element, GeomRole::kCollision);
    if (!geom) continue;
    geom->geom.surface = options.bullet ? SurfaceMaterial{} : read_surface(element);
    if (contact) read_contact(contact, geom->geom.surface);
    if (masks) geom->geom.filter = read_filter(element);
    result.geoms.push_back(std::move(*geom));
  }
  return result;
}

}  // namespace manyhands::io
