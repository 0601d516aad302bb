// Which geoms may touch: contype and conaffinity, <contact>'s pairs and exclusions, and MuJoCo's rules for neighbours.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_scene.h"

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
  masks.reserve(kinds.size());
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

/// The surface of a <pair>, which owes nothing to those of its geoms.
SurfaceMaterial read_surface(const MjcfElement& e) {
  std::array<double, 5> friction{1, 1, 0.005, 0.0001, 0.0001};  // sliding twice, spinning, rolling twice
  if (e.has("friction")) std::ranges::copy(e.numbers("friction", 1, 5), friction.begin());
  if (*std::ranges::min_element(friction) < 0) e.fail("a coefficient of friction is negative; expected 0 or more");
  if (friction[0] != friction[1] || friction[3] != friction[4]) {
    e.note(LoadAction::kRepaired, "frictions differ by direction; the first of each counts");
  }
  return surface_of({friction[0], friction[2], friction[3]}, read_condim(e, 3));
}

/// Of several pairs of the same geoms, each is a contact in MuJoCo, and that of the larger friction carries the force.
void add_surface(const MjcfElement& e, SurfaceMaterial& largest, const SurfaceMaterial& surface) {
  if (surface.fields() != largest.fields()) {
    e.note(LoadAction::kRepaired, "there is a pair of these geoms already, of other friction; the larger acts");
  }
  const auto take = [](double& most, double value) { most = std::max(most, value); };
  take(largest.lateral_friction, surface.lateral_friction);
  take(largest.spinning_friction, surface.spinning_friction);
  take(largest.rolling_friction, surface.rolling_friction);
}

void read_pair(MjcfScene& scene, const MjcfElement& element) {
  const std::string name = element.text_or("name", "");
  const MjcfElement e = element.named("pair '" + name + "'").with_defaults(scene.classes, "pair");
  e.expect(
      {"name", "class", "geom1", "geom2", "condim", "friction", "solref", "solimp", "solreffriction", "margin", "gap"});
  e.ignore({"solreffriction", "margin", "gap"});
  MjcfGeom& a = scene.geoms[scene.geom(e, "geom1")];
  MjcfGeom& b = scene.geoms[scene.geom(e, "geom2")];
  if (!a.id || !b.id) {
    e.note(LoadAction::kIgnored, "one of its geoms was left out, and so is the pair");
    return;
  }
  a.is_in_pair = b.is_in_pair = true;
  SurfaceMaterial surface = read_surface(e);
  surface.compliance = read_compliance(e, scene.compliance, "solref", "solimp");
  const auto [entry, is_new] = scene.pairs.emplace(std::minmax(*a.id, *b.id), surface);
  if (!is_new) add_surface(e, entry->second, surface);
}

void read_exclude(MjcfScene& scene, const MjcfElement& element) {
  const MjcfElement e = element.named("exclude '" + element.text_or("name", "") + "'");
  e.expect({"name", "body1", "body2"});
  const LinkId a = scene.body(e, "body1").link, b = scene.body(e, "body2").link;
  scene.exclusions.insert({std::min(a, b), std::max(a, b)});
  scene.builder.exclude_contact(a, b);
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
        if (inner.first_moving != static_cast<int>(i)) continue;
        const auto links = std::minmax(outer.link, inner.link);
        if (scene.exclusions.insert(links).second) scene.builder.exclude_contact(outer.link, inner.link);
      }
    }
  }
}

/// Whether one of two bodies that joints move hangs on the other.
bool are_neighbours(const MjcfScene& scene, int a, int b) {
  const auto body = [&](int i) -> const MjcfBody& { return scene.bodies[static_cast<std::size_t>(i)]; };
  const auto is_parent_of = [&](int parent, int child) { return body(body(child).parent).first_moving == parent; };
  return a != 0 && b != 0 && (is_parent_of(a, b) || is_parent_of(b, a));
}

/// MuJoCo's whole rule: kinds, bodies that move as one, parents and children, exclusions.
bool may_touch(const MjcfScene& scene, const MjcfGeom& a, const MjcfGeom& b) {
  if (!may_touch(Kind{a.contype, a.conaffinity}, Kind{b.contype, b.conaffinity})) return false;
  const auto body = [&](int i) -> const MjcfBody& { return scene.bodies[static_cast<std::size_t>(i)]; };
  const int moving_a = body(a.body).first_moving, moving_b = body(b.body).first_moving;
  if (moving_a == moving_b) return false;
  if (scene.settings.flags.filter_parent && are_neighbours(scene, moving_a, moving_b)) return false;
  const LinkId link_a = body(a.body).link, link_b = body(b.body).link;
  return !scene.exclusions.contains({std::min(link_a, link_b), std::max(link_a, link_b)});
}

/// Whether one moves by a single joint on the other, which is fixed: neighbours that do not touch here, but in MuJoCo.
bool is_on_base(const MjcfScene& scene, const MjcfGeom& geom, const MjcfGeom& base) {
  const int moving = scene.bodies[static_cast<std::size_t>(geom.body)].first_moving;
  const MjcfBody& body = scene.bodies[static_cast<std::size_t>(moving)];
  return moving != 0 && base.body != 0 && body.parent == base.body && !body.has_chain &&
         scene.bodies[static_cast<std::size_t>(base.body)].first_moving == 0;
}

/// MuJoCo's surface of two geoms: the larger condim and frictions, or those of the geom of higher priority.
SurfaceMaterial surface_between(const MjcfGeom& a, const MjcfGeom& b) {
  SurfaceMaterial surface;
  if (a.priority != b.priority) {
    const MjcfGeom& higher = a.priority > b.priority ? a : b;
    surface = surface_of(higher.friction, higher.condim);
    if (gives_way(higher.compliance)) surface.compliance = higher.compliance;
    return surface;
  }
  std::array<double, 3> friction{};
  for (std::size_t i = 0; i < 3; ++i) friction[i] = std::max(a.friction[i], b.friction[i]);
  surface = surface_of(friction, std::max(a.condim, b.condim));
  surface.compliance = between(a.compliance, b.compliance);
  return surface;
}

/// Whether filters and the larger friction of both surfaces say here what MuJoCo has for two geoms.
bool is_usual(const MjcfGeom& a, const MjcfGeom& b) {
  const SurfaceMaterial theirs = surface_between(a, b);
  const SurfaceMaterial own_a = surface_of(a.friction, a.condim), own_b = surface_of(b.friction, b.condim);
  const bool is_largest = theirs.lateral_friction == std::max(own_a.lateral_friction, own_b.lateral_friction) &&
                          theirs.spinning_friction == std::max(own_a.spinning_friction, own_b.spinning_friction) &&
                          theirs.rolling_friction == std::max(own_a.rolling_friction, own_b.rolling_friction);
  return is_largest && (a.priority == b.priority || (!a.compliance && !b.compliance));
}

/// Whether geoms that are not filtered in MuJoCo may be filtered here, for their bodies lie next to each other.
bool is_filtered_here(const MjcfScene& scene, const MjcfGeom& a, const MjcfGeom& b) {
  const auto moving = [&](const MjcfGeom& geom) {
    return scene.bodies[static_cast<std::size_t>(geom.body)].first_moving;
  };
  return is_on_base(scene, a, b) || is_on_base(scene, b, a) || are_neighbours(scene, moving(a), moving(b));
}

/// The geoms that were not left out, by what they have in common: indices into the scene's, rising.
struct GeomGroups {
  std::vector<std::vector<std::size_t>> by_surface;  ///< alike in all that `is_usual` asks for
  std::map<int, std::vector<std::size_t>> by_body, by_first_moving;
};

GeomGroups group_geoms(const MjcfScene& scene) {
  GeomGroups groups;
  const auto is_alike = [](const MjcfGeom& a, const MjcfGeom& b) {
    return a.friction == b.friction && a.condim == b.condim && a.priority == b.priority && a.compliance == b.compliance;
  };
  std::map<std::array<double, 5>, std::vector<std::size_t>> found;  // groups by numbers; few differ by compliance alone
  for (std::size_t i = 0; i < scene.geoms.size(); ++i) {
    const MjcfGeom& geom = scene.geoms[i];
    if (!geom.id) continue;
    groups.by_body[geom.body].push_back(i);
    groups.by_first_moving[scene.bodies[static_cast<std::size_t>(geom.body)].first_moving].push_back(i);
    const auto& f = geom.friction;
    std::vector<std::size_t>& candidates =
        found[{f[0], f[1], f[2], static_cast<double>(geom.condim), static_cast<double>(geom.priority)}];
    const auto group = std::ranges::find_if(
        candidates, [&](std::size_t number) { return is_alike(scene.geoms[groups.by_surface[number].front()], geom); });
    if (group != candidates.end()) {
      groups.by_surface[*group].push_back(i);
    } else {
      candidates.push_back(groups.by_surface.size());
      groups.by_surface.push_back({i});
    }
  }
  return groups;
}

/// Calls visit(index, index) for all pairs of geoms that are not usual, and for all that may be filtered here; for some
/// twice, for some that are neither.
template <class Visit>
void visit_special_pairs(const MjcfScene& scene, Visit&& visit) {
  const GeomGroups groups = group_geoms(scene);
  for (std::size_t n = 0; n < groups.by_surface.size(); ++n) {
    for (std::size_t m = 0; m <= n; ++m) {
      const std::vector<std::size_t>&some = groups.by_surface[n], &others = groups.by_surface[m];
      if (is_usual(scene.geoms[some.front()], scene.geoms[others.front()])) continue;
      for (const std::size_t i : some) {
        for (const std::size_t k : others) visit(i, k);
      }
    }
  }
  for (const auto& [moving, geoms] : groups.by_first_moving) {
    const int parent = moving == 0 ? 0 : scene.bodies[static_cast<std::size_t>(moving)].parent;
    if (parent == 0) continue;
    const int around = scene.bodies[static_cast<std::size_t>(parent)].first_moving;
    const auto& near = around == 0 ? groups.by_body : groups.by_first_moving;
    const auto others = near.find(around == 0 ? parent : around);
    if (others == near.end()) continue;
    for (const std::size_t i : geoms) {
      for (const std::size_t k : others->second) visit(i, k);
    }
  }
}

/// The file's pairs and those that say what filters and the larger friction of two surfaces cannot, in the order of
/// their geoms.
void add_pairs(MjcfScene& scene) {
  constexpr std::size_t kMostPairs = 1'000'000;
  std::map<std::pair<GeomId, GeomId>, std::optional<SurfaceMaterial>> pairs;
  for (const auto& [geoms, surface] : scene.pairs) pairs.emplace(geoms, surface);
  visit_special_pairs(scene, [&](std::size_t i, std::size_t k) {
    if (i == k) return;
    const MjcfGeom &a = scene.geoms[std::min(i, k)], &b = scene.geoms[std::max(i, k)];
    const bool usual = is_usual(a, b);
    if (usual && !is_filtered_here(scene, a, b)) return;
    if (scene.pairs.contains({*a.id, *b.id}) || !may_touch(scene, a, b)) return;
    pairs.emplace(std::pair{*a.id, *b.id}, usual ? std::nullopt : std::optional(surface_between(a, b)));
    if (pairs.size() > kMostPairs) {
      scene.root.fail(
          "geoms of several frictions, condims or solrefs make more than 1,000,000 pairs with a surface of "
          "their own; give them the same, or contype and conaffinity so that fewer may touch");
    }
  });
  for (const auto& [geoms, surface] : pairs) {
    scene.builder.add_contact_pair({.a = geoms.first, .b = geoms.second, .surface = surface});
  }
}

/// Bullet has filters, and no pairs.
void set_bullets_rules(MjcfScene& scene) {
  scene.builder.set_contact_rules(
      {.friction = CombineRule::kProduct, .restitution = CombineRule::kProduct, .self_collision = false});
  set_filters(scene);
  set_roles(scene);
}

}  // namespace

void read_contacts(MjcfScene& scene) {
  if (scene.root.source().is_bullet()) return set_bullets_rules(scene);
  for (const MjcfElement& section : scene.sections("contact")) {
    section.named("contact").expect({}, {"pair", "exclude"});
    for (const MjcfElement& element : scene.elements(section)) {
      if (element.tag() == "pair") read_pair(scene, element);
      if (element.tag() == "exclude") read_exclude(scene, element);
    }
  }
  set_filters(scene);
  set_roles(scene);
  if (scene.settings.flags.filter_parent) exclude_across_chains(scene);
  add_pairs(scene);
  scene.builder.set_contact_rules({.friction = CombineRule::kMaximum, .contacts = scene.settings.flags.contact});
}

}  // namespace manyhands::io
