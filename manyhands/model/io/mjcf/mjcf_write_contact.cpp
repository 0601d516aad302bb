// contype and conaffinity, <pair> and <exclude>: who touches whom, and with what friction.
#include <algorithm>
#include <bit>

#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_writer.h"

namespace manyhands::io {

namespace {

bool meet(const CollisionFilter& a, const CollisionFilter& b) {
  return (a.group & b.mask) != 0 && (b.group & a.mask) != 0;
}

std::pair<GeomId, GeomId> in_order(GeomId a, GeomId b) { return {std::min(a, b), std::max(a, b)}; }

class ContactWriter {
 public:
  explicit ContactWriter(MjcfWriter& writer) : writer_(writer), model_(writer.model) {
    for (const ContactPair& pair : model_.contact_pairs()) pairs_.insert(in_order(pair.a, pair.b));
    for (const ContactExclusion& e : model_.exclusions()) excluded_.insert(std::minmax(e.a, e.b));
    for (std::size_t i = 0; i < model_.geoms().size(); ++i) {
      if (model_.geoms()[i].role == GeomRole::kCollision && !writer_.geom_names[i].empty()) geoms_.emplace_back(i);
    }
  }

  void write() {
    section_ = writer_.root.append_child("contact");
    for (const ContactExclusion& e : model_.exclusions()) write_exclude(e.a, e.b);
    exclude_bases();
    if (!model_.contact_rules().self_collision) exclude_trees();
    for (const ContactPair& pair : model_.contact_pairs()) write_pair(pair);
    combine_frictions();
    if (!section_.first_child()) writer_.root.remove_child(section_);
  }

 private:
  [[nodiscard]] const Geom& geom(GeomId id) const { return model_.geoms()[id.index()]; }
  [[nodiscard]] const Link& link_of(GeomId id) const { return model_.link(geom(id).link); }

  /// Whether `moving` rests on the base that `fixed` belongs to: these touch in MuJoCo, but not here.
  [[nodiscard]] bool is_on_base(GeomId moving, GeomId fixed) const {
    const Link& link = link_of(moving);
    if (link.body.value() == 0 || link_of(fixed).body.value() != 0 || geom(fixed).link == LinkId(0)) return false;
    const Body& body = model_.body(link.body);
    return body.parent.value() == 0 && body.type != JointType::kFloating &&
           model_.joint(body.joint).parent == geom(fixed).link;
  }

  [[nodiscard]] bool are_neighbours(BodyId a, BodyId b) const {
    const auto is_parent = [&](BodyId parent, BodyId child) {
      return child.value() != 0 && parent.value() != 0 && model_.body(child).parent == parent;
    };
    return a == b || is_parent(a, b) || is_parent(b, a);
  }

  [[nodiscard]] bool may_touch(GeomId a, GeomId b) const {
    return meet(geom(a).filter, geom(b).filter) && !are_neighbours(link_of(a).body, link_of(b).body) &&
           !excluded_.contains(std::minmax(geom(a).link, geom(b).link));
  }

  void write_exclude(LinkId a, LinkId b) {
    if (!writer_.carried_by[a.index()].is_valid() || !writer_.carried_by[b.index()].is_valid()) return;
    pugi::xml_node node = section_.append_child("exclude");
    set(node, "body1", writer_.body(a));
    set(node, "body2", writer_.body(b));
  }

  void exclude(GeomId a, GeomId b) {
    if (excluded_.insert(std::minmax(geom(a).link, geom(b).link)).second) write_exclude(geom(a).link, geom(b).link);
  }

  template <class Visit>
  void for_each_pair(Visit visit) {
    for (std::size_t i = 0; i < geoms_.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) visit(geoms_[k], geoms_[i]);
    }
  }

  void exclude_bases() {
    for_each_pair([&](GeomId a, GeomId b) {
      if ((is_on_base(a, b) || is_on_base(b, a)) && may_touch(a, b) && !pairs_.contains({a, b})) exclude(a, b);
    });
  }

  void exclude_trees() {
    for_each_pair([&](GeomId a, GeomId b) {
      if (model_.root_link(geom(a).link) == model_.root_link(geom(b).link) && may_touch(a, b)) exclude(a, b);
    });
  }

  [[nodiscard]] static double combined(CombineRule rule, double a, double b) {
    switch (rule) {
      case CombineRule::kProduct:
        return a * b;
      case CombineRule::kGeometricMean:
        return std::sqrt(a * b);
      case CombineRule::kMaximum:
        return std::max(a, b);
      case CombineRule::kMinimum:
        return std::min(a, b);
    }
    return 0;
  }

  /// The surface of two geoms without a pair of their own.
  [[nodiscard]] SurfaceMaterial surface_between(GeomId a, GeomId b) const {
    const CombineRule rule = model_.contact_rules().friction;
    const SurfaceMaterial &A = geom(a).surface, &B = geom(b).surface;
    SurfaceMaterial surface;
    surface.lateral_friction = combined(rule, A.lateral_friction, B.lateral_friction);
    surface.spinning_friction = std::max(A.spinning_friction, B.spinning_friction);
    surface.rolling_friction = std::max(A.rolling_friction, B.rolling_friction);
    surface.compliance = between(A.compliance, B.compliance);
    return surface;
  }

  void write_pair(const ContactPair& pair) {
    // Without a surface it says that a body touches its base, which readers of MJCF know.
    const bool is_base = is_on_base(pair.a, pair.b) || is_on_base(pair.b, pair.a);
    if (!pair.surface && is_base && may_touch(pair.a, pair.b)) return;
    write_pair(pair.a, pair.b, pair.surface.value_or(surface_between(pair.a, pair.b)));
  }

  void write_pair(GeomId a, GeomId b, const SurfaceMaterial& surface) {
    const std::string &first = writer_.geom_names[a.index()], &second = writer_.geom_names[b.index()];
    if (first.empty() || second.empty()) return;
    pugi::xml_node node = section_.append_child("pair");
    set(node, "geom1", first);
    set(node, "geom2", second);
    const std::string what = "the pair of " + part("geom", first) + " and " + part("geom", second);
    write_surface(node, surface, true);
    write_compliance(writer_, node, what, surface.compliance, "solref", "solimp");
    note_surface(writer_, surface, what);
  }

  /// MJCF takes the larger friction; where the model's rule gives another, a pair says so.
  void combine_frictions() {
    if (model_.contact_rules().friction == CombineRule::kMaximum) return;
    for_each_pair([&](GeomId a, GeomId b) {
      const SurfaceMaterial &A = geom(a).surface, &B = geom(b).surface, both = surface_between(a, b);
      const bool is_larger = both.lateral_friction == std::max(A.lateral_friction, B.lateral_friction);
      if (!is_larger && may_touch(a, b) && !pairs_.contains({a, b})) write_pair(a, b, both);
    });
    writer_.notes.changed("contact", "frictions combine by the maximum in MJCF; where that is another, pairs say so");
  }

  MjcfWriter& writer_;
  const Model& model_;
  pugi::xml_node section_;
  std::vector<GeomId> geoms_;
  std::set<std::pair<GeomId, GeomId>> pairs_;
  std::set<std::pair<LinkId, LinkId>> excluded_;
};

/// Whether MuJoCo's rule of contype and conaffinity, with the groups and masks themselves, is ours.
bool says_the_same(const std::vector<CollisionFilter>& kinds) {
  constexpr std::uint32_t kSign = 0x80000000u;
  return std::ranges::all_of(kinds, [&](const CollisionFilter& a) {
    const bool is_plain = std::has_single_bit(a.group) && a.group != kSign;
    return is_plain && std::ranges::all_of(kinds, [&](const CollisionFilter& b) {
             return ((a.group & b.mask) != 0 || (b.group & a.mask) != 0) == meet(a, b);
           });
  });
}

}  // namespace

void choose_filters(MjcfWriter& writer) {
  const std::span<const Geom> geoms = writer.model.geoms();
  std::vector<CollisionFilter> kinds;
  const auto kind_of = [&](const CollisionFilter& filter) {
    return std::ranges::find_if(
               kinds,
               [&](const CollisionFilter& kind) { return kind.group == filter.group && kind.mask == filter.mask; }) -
           kinds.begin();
  };
  for (const Geom& geom : geoms) {
    const bool is_new = kind_of(geom.filter) == std::ssize(kinds);
    if (geom.role == GeomRole::kCollision && is_new) kinds.push_back(geom.filter);
  }
  const bool keeps_bits = says_the_same(kinds);
  constexpr std::size_t kMostKinds = 31;
  if (!keeps_bits && kinds.size() > kMostKinds)
    throw SaveError("more than 31 kinds of collision filters; MJCF has no more");
  std::uint32_t used = 1;  // of geoms by default, which readers reckon with whether there are any or not
  for (const CollisionFilter& kind : kinds) used |= kind.group;
  writer.filters.assign(geoms.size(), {0, 0});
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    if (geoms[i].role != GeomRole::kCollision) continue;
    auto& [contype, conaffinity] = writer.filters[i];
    if (keeps_bits) {
      contype = static_cast<int>(geoms[i].filter.group);
      conaffinity = static_cast<int>(geoms[i].filter.mask & used);
      continue;
    }
    contype = 1 << kind_of(geoms[i].filter);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      if (meet(geoms[i].filter, kinds[k])) conaffinity |= 1 << k;
    }
  }
}

void write_contacts(MjcfWriter& writer) { ContactWriter(writer).write(); }

}  // namespace manyhands::io
