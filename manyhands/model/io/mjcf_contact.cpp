// Which geoms may touch: contype and conaffinity, <contact>'s pairs and exclusions, and MuJoCo's rules for neighbours.
#include <algorithm>
#include <set>
#include <utility>

#include "manyhands/model/io/mjcf_scene.h"

namespace manyhands::io {

namespace {

using Kind = std::pair<int, int>;  // contype, conaffinity

bool may_touch(const Kind& a, const Kind& b) { return (a.first & b.second) != 0 || (b.first & a.second) != 0; }

// MuJoCo lets two geoms touch if either's contype meets the other's conaffinity; here each one's group must be in the
// other's mask. With one bit of group for each kind of geom, and in its mask the bits of all kinds that it may touch,
// the two rules are one. The default kind keeps bit 0, and bits that no kind has go with it, so that geoms added in
// code, of group 1 and every mask, meet those of the file as geoms by default would.
std::vector<Kind> kinds_of(const MjcfScene& scene) {
  std::set<Kind> found{{1, 1}};
  for (const MjcfGeom& geom : scene.geoms) found.emplace(geom.contype, geom.conaffinity);
  const auto behave_alike = [&](const Kind& a, const Kind& b) {
    return std::ranges::all_of(found, [&](const Kind& other) { return may_touch(a, other) == may_touch(b, other); });
  };
  std::vector<Kind> kinds{{1, 1}};
  for (const Kind& kind : found) {
    if (std::ranges::any_of(kinds, [&](const Kind& other) { return behave_alike(kind, other); })) continue;
    kinds.push_back(kind);
    if (kinds.size() > 32) scene.root.fail("contype and conaffinity make more than 32 kinds of geoms; expected fewer");
  }
  return kinds;
}

void set_filters(MjcfScene& scene) {
  const std::vector<Kind> kinds = kinds_of(scene);
  const std::uint32_t used = kinds.size() < 32 ? (1u << kinds.size()) - 1 : 0xffffffffu;
  const auto mask_of = [&](const Kind& kind) {
    std::uint32_t mask = may_touch(kind, {1, 1}) ? ~used : 0;
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      if (may_touch(kind, kinds[k])) mask |= 1u << k;
    }
    return mask;
  };
  std::vector<std::uint32_t> masks;
  for (const Kind& kind : kinds) masks.push_back(mask_of(kind));
  for (const MjcfGeom& entry : scene.geoms) {
    if (!entry.id) continue;
    const std::uint32_t mask = mask_of({entry.contype, entry.conaffinity});
    const auto kind = static_cast<std::size_t>(std::ranges::find(masks, mask) - masks.begin());
    Geom& geom = scene.builder.geom(*entry.id);
    geom.filter = {.group = 1u << kind, .mask = mask};
  }
}

/// What touches nothing is only seen; as a mesh it keeps its own surface.
void set_roles(MjcfScene& scene) {
  for (const MjcfGeom& entry : scene.geoms) {
    if (!entry.id || entry.is_in_pair || entry.contype != 0 || entry.conaffinity != 0) continue;
    Geom& geom = scene.builder.geom(*entry.id);
    geom.role = GeomRole::kVisual;
    if (geom.shape.type == ShapeType::kConvex) geom.shape.type = ShapeType::kMesh;
  }
}

void read_pair(MjcfScene& scene, const MjcfElement& element) {
  const std::string name = element.text_or("name", "");
  const MjcfElement e = element.named("pair '" + name + "'").with_defaults(scene.classes, "pair");
  e.expect(
      {"name", "class", "geom1", "geom2", "condim", "friction", "solref", "solimp", "solreffriction", "margin", "gap"});
  e.ignore({"solref", "solimp", "solreffriction", "margin", "gap"});
  MjcfGeom& a = scene.geoms[scene.geom(e, "geom1")];
  MjcfGeom& b = scene.geoms[scene.geom(e, "geom2")];
  if (!a.id || !b.id) {
    e.note(LoadAction::kIgnored, "one of its geoms was left out, and so is the pair");
    return;
  }
  a.is_in_pair = b.is_in_pair = true;
  ContactPair pair{.a = *a.id, .b = *b.id};
  if (e.has("condim") || e.has("friction")) {
    const SurfaceMaterial &sa = scene.builder.geom(*a.id).surface, &sb = scene.builder.geom(*b.id).surface;
    std::array<double, 3> friction{std::max(sa.lateral_friction, sb.lateral_friction),
                                   std::max(sa.spinning_friction, sb.spinning_friction),
                                   std::max(sa.rolling_friction, sb.rolling_friction)};
    const std::vector<double> given = e.has("friction") ? e.numbers("friction", 1, 5) : std::vector<double>{};
    constexpr std::array<std::size_t, 5> kMeaning{0, 0, 1, 2, 2};  // sliding twice, spinning, rolling twice
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (given[i] < 0) e.fail("a coefficient of friction is negative; expected 0 or more");
      const bool is_second = i == 1 || i == 4;
      if (is_second && given[i] != given[i - 1]) {
        e.note(LoadAction::kRepaired, "frictions differ by direction; the first of each counts");
      }
      if (!is_second) friction[kMeaning[i]] = given[i];
    }
    pair.surface = surface_of(friction, read_condim(e, std::max(a.condim, b.condim)));
  }
  if (!scene.pairs.insert({std::min(*a.id, *b.id), std::max(*a.id, *b.id)}).second) {
    e.fail("there is a pair of these geoms already; expected it once");
  }
  scene.builder.add_contact_pair(pair);
}

void read_exclude(MjcfScene& scene, const MjcfElement& element) {
  const MjcfElement e = element.named("exclude '" + element.text_or("name", "") + "'");
  e.expect({"name", "body1", "body2"});
  const LinkId a = scene.body(e, "body1").link, b = scene.body(e, "body2").link;
  scene.exclusions.insert({std::min(a, b), std::max(a, b)});
  scene.builder.exclude_contact(a, b);
}

/// MuJoCo lets a moving body touch the fixed one that its joint is on; here neighbours of a joint do not touch unless a
/// pair says so.
void pair_with_bases(MjcfScene& scene) {
  const auto base_of = [&](const MjcfGeom& geom) {
    const MjcfBody& body = scene.bodies[static_cast<std::size_t>(geom.body)];
    const MjcfBody& moving = scene.bodies[static_cast<std::size_t>(body.first_moving)];
    const bool is_on_base = body.first_moving != 0 && moving.parent > 0 &&
                            scene.bodies[static_cast<std::size_t>(moving.parent)].first_moving == 0;
    return is_on_base && !moving.has_chain ? moving.parent : -1;
  };
  for (const MjcfGeom& moving : scene.geoms) {
    const int base = base_of(moving);
    if (base < 0 || !moving.id) continue;
    for (const MjcfGeom& fixed : scene.geoms) {
      const Kind a{moving.contype, moving.conaffinity}, b{fixed.contype, fixed.conaffinity};
      if (fixed.body != base || !fixed.id || !may_touch(a, b)) continue;
      const LinkId link_a = scene.bodies[static_cast<std::size_t>(moving.body)].link;
      const LinkId link_b = scene.bodies[static_cast<std::size_t>(base)].link;
      if (scene.exclusions.contains({std::min(link_a, link_b), std::max(link_a, link_b)})) continue;
      const std::pair ids{std::min(*moving.id, *fixed.id), std::max(*moving.id, *fixed.id)};
      if (!scene.pairs.contains(ids)) scene.builder.add_contact_pair({.a = ids.first, .b = ids.second});
    }
  }
}

/// Bodies that lie next to each other in MuJoCo, though links between their joints part them here.
void exclude_across_chains(MjcfScene& scene) {
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const MjcfBody& body = scene.bodies[i];
    if (!body.has_chain) continue;
    const int around = scene.bodies[static_cast<std::size_t>(body.parent)].first_moving;
    if (around == 0) continue;
    for (const MjcfBody& outer : scene.bodies) {
      if (outer.first_moving != around) continue;
      for (const MjcfBody& inner : scene.bodies) {
        if (inner.first_moving == static_cast<int>(i)) scene.builder.exclude_contact(outer.link, inner.link);
      }
    }
  }
}

/// Where the larger friction of two geoms is not what MuJoCo takes.
void note_mixed_condims(const MjcfScene& scene) {
  const MjcfGeom* least = nullptr;
  const MjcfGeom* most = nullptr;
  for (const MjcfGeom& geom : scene.geoms) {
    if (!geom.id || (geom.contype == 0 && geom.conaffinity == 0 && !geom.is_in_pair)) continue;
    if (least == nullptr || geom.condim < least->condim) least = &geom;
    if (most == nullptr || geom.condim > most->condim) most = &geom;
  }
  if (least == nullptr || least->condim == most->condim) return;
  least->source.note(LoadAction::kIgnored,
                     "condim " + std::to_string(least->condim) + " beside condim " + std::to_string(most->condim) +
                         ": frictions that a geom's own condim leaves out count as 0 when it touches one of more");
}

}  // namespace

void read_contacts(MjcfScene& scene) {
  for (const MjcfElement& section : scene.root.children("contact")) {
    section.named("contact").expect({}, {"pair", "exclude"});
    for (const MjcfElement& element : section.children()) {
      if (element.tag() == "pair") read_pair(scene, element);
      if (element.tag() == "exclude") read_exclude(scene, element);
    }
  }
  set_filters(scene);
  set_roles(scene);
  exclude_across_chains(scene);
  pair_with_bases(scene);
  note_mixed_condims(scene);
  scene.builder.set_contact_rules({.friction = CombineRule::kMaximum});
}

}  // namespace manyhands::io
