// Client: contacts, distances and rays.
#include <algorithm>
#include <cmath>

#include "manyhands/bullet/client_body.h"
#include "manyhands/physics/collision/queries/queries.h"

namespace manyhands::bullet {

namespace {

/// The two directions across a normal along which PyBullet tells friction (btPlaneSpace1, the other way round).
std::array<Vec3<double>, 2> friction_directions(const Vec3<double>& n) {
  if (std::abs(n.z) > std::sqrt(0.5)) {
    const double a = n.y * n.y + n.z * n.z, k = 1 / std::sqrt(a);
    const Vec3<double> first{0, n.z * k, -n.y * k};
    return {first, {a * k, n.x * first.z, -n.x * first.y}};
  }
  const double a = n.x * n.x + n.y * n.y, k = 1 / std::sqrt(a);
  const Vec3<double> first{n.y * k, -n.x * k, 0};
  return {first, {n.z * first.y, -n.z * first.x, a * k}};
}

/// With the friction on B along the directions that belong to the normal.
ContactReading told(ContactReading c) {
  const auto [first, second] = friction_directions(c.normal_on_b);
  c.direction_1 = first;
  c.direction_2 = second;
  c.friction_1 = dot(c.friction, first);
  c.friction_2 = dot(c.friction, second);
  return c;
}

ContactReading swapped(const ContactReading& c) {
  ContactReading other = c;
  std::swap(other.body_a, other.body_b);
  std::swap(other.link_a, other.link_b);
  std::swap(other.on_a, other.on_b);
  other.normal_on_b = -c.normal_on_b;
  other.friction = -c.friction;
  return other;
}

}  // namespace

/// What the last step found is lost when parts come or go: it is read before.
void Client::keep_contacts() {
  if (contacts_known_) return;
  contacts_known_ = true;
  contacts_.clear();
  locate_all();
  for (const Contact& contact : world_.contacts()) {
    const auto [body_a, link_a] = owners_[contact.link_a.index()];
    const auto [body_b, link_b] = owners_[contact.link_b.index()];
    if (body_a < 0 || body_b < 0) continue;
    ContactReading c{.body_a = body_a, .body_b = body_b, .link_a = link_a, .link_b = link_b};
    const Vec3<double> half = (0.5 * contact.distance) * contact.normal;
    c.on_a = contact.position - half;
    c.on_b = contact.position + half;
    c.normal_on_b = -contact.normal;
    c.distance = contact.distance;
    c.normal_force = contact.normal_force;
    c.friction = contact.friction_force;
    contacts_.push_back(c);
  }
}

void Client::detect_collisions() {
  contacts_.clear();
  contacts_known_ = true;
  locate_all();
  for (const LinkDistance& pair : world_.near_links(0)) {
    const auto [body_a, link_a] = owners_[pair.link_a.index()];
    const auto [body_b, link_b] = owners_[pair.link_b.index()];
    if (body_a < 0 || body_b < 0) continue;
    contacts_.push_back({.body_a = body_a,
                         .body_b = body_b,
                         .link_a = link_a,
                         .link_b = link_b,
                         .on_a = pair.surfaces.p_A,
                         .on_b = pair.surfaces.p_B,
                         .normal_on_b = -pair.surfaces.normal_AB,
                         .distance = pair.surfaces.phi});
  }
}

std::vector<ContactReading> Client::contacts(int body_a, int body_b, int link_a, int link_b) {
  constexpr int kAny = -2;
  keep_contacts();
  std::vector<ContactReading> found;
  const auto fits = [](int asked, int is) { return asked == kAny || asked == is; };
  for (const ContactReading& contact : contacts_) {
    ContactReading c = contact;
    if (body_a >= 0) {
      if (c.body_a != body_a) c = swapped(c);
      if (c.body_a != body_a) continue;
      if (body_b < 0 || body_b == c.body_b) {
        if (fits(link_a, c.link_a) && fits(link_b, c.link_b)) found.push_back(told(c));
      }
    } else if (body_b < 0 || c.body_a == body_b || c.body_b == body_b) {
      if (fits(link_a, c.link_a) && fits(link_b, c.link_b)) found.push_back(told(c));
    }
  }
  return found;
}

std::vector<ContactReading> Client::closest_points(int body_a, int body_b, double distance, int link_a, int link_b) {
  Body *const a = find(body_a), *const b = find(body_b);
  std::vector<ContactReading> found;
  if (a == nullptr || b == nullptr || distance < 0) return found;
  const auto range = [](const Body& body, int link) {
    return link == -2 ? std::pair(-1, body.plan.num_links() - 1) : std::pair(link, link);
  };
  const auto [first_a, last_a] = range(*a, link_a);
  const auto [first_b, last_b] = range(*b, link_b);
  if (!a->has_link(first_a) || !b->has_link(first_b)) return found;
  locate_all();
  for (int i = first_a; i <= last_a; ++i) {
    if (a->plan.link(i).collisions.empty()) continue;
    for (int k = first_b; k <= last_b; ++k) {
      if (b->plan.link(k).collisions.empty() || (a == b && (i == k || (link_a == -2 && k < i)))) continue;
      const std::optional<LinkDistance> d = world_.link_distance(link_id(*a, i), link_id(*b, k));
      if (!d || !(d->surfaces.phi <= distance)) continue;
      found.push_back({.body_a = body_a,
                       .body_b = body_b,
                       .link_a = i,
                       .link_b = k,
                       .on_a = d->surfaces.p_A,
                       .on_b = d->surfaces.p_B,
                       .normal_on_b = -d->surfaces.normal_AB,
                       .distance = d->surfaces.phi});
    }
  }
  return found;
}

std::vector<RayReading> Client::cast_rays(std::span<const Vec3<double>> from, std::span<const Vec3<double>> to,
                                          int mask, int number) {
  locate_all();
  std::vector<RayReading> readings(from.size());
  std::vector<Vec3<double>> origins(from.begin(), from.end()), directions(from.size());
  std::vector<double> lengths(from.size());
  double farthest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    directions[i] = to[i] - from[i];
    lengths[i] = norm(directions[i]);
    if (!(lengths[i] > 1e-12)) directions[i] = {0, 0, 1};
    farthest = std::max(farthest, lengths[i]);
  }
  const auto hits = world_.ray_cast(origins, directions, farthest);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!hits[i] || hits[i]->distance > lengths[i]) continue;
    std::vector<WorldRayHit> all{*hits[i]};
    if (number > 0 || !counts(*hits[i], mask)) all = world_.ray_cast_all(origins[i], directions[i], lengths[i]);
    std::vector<LinkId> met;  // each link counts once
    for (const WorldRayHit& hit : all) {
      if (!counts(hit, mask) || std::ranges::find(met, hit.link) != met.end()) continue;
      met.push_back(hit.link);
      if (static_cast<int>(met.size()) <= number) continue;
      const auto [body, link] = owners_[hit.link.index()];
      readings[i] = {body, link, hit.distance / lengths[i], hit.point, hit.normal};
      break;
    }
  }
  return readings;
}

/// PyBullet's rays tell nothing of what they begin in.
bool Client::counts(const WorldRayHit& hit, int mask) {
  const auto [body, link] = owners_[hit.link.index()];
  return hit.distance > 0 && body >= 0 && (find(body)->of(link).filter[0] & mask) != 0;
}

// ---- what may touch -----------------------------------------------------------------------------------------------

bool Client::may_collide(const Body& a, int link_a, const Body& b, int link_b) const {
  const auto swap = std::array{b.id, link_b, a.id, link_a} < std::array{a.id, link_a, b.id, link_b};
  const std::array<int, 4> key = swap ? std::array{b.id, link_b, a.id, link_a} : std::array{a.id, link_a, b.id, link_b};
  if (const auto rule = pair_rules_.find(key); rule != pair_rules_.end()) return rule->second;
  const auto &fa = a.of(link_a).filter, &fb = b.of(link_b).filter;
  const bool a_wants = (fa[0] & fb[1]) != 0, b_wants = (fb[0] & fa[1]) != 0;
  return settings_.filter_mode == 0 ? a_wants && b_wants : a_wants || b_wants;
}

void Client::set_collision_pair(int id_a, int id_b, int link_a, int link_b, bool enabled) {
  const std::array<int, 4> key =
      std::min(std::array{id_a, link_a, id_b, link_b}, std::array{id_b, link_b, id_a, link_a});
  pair_rules_[key] = enabled;
  Body *const a = find(id_a), *const b = find(id_b);
  if (a == nullptr || b == nullptr || !a->has_link(link_a) || !b->has_link(link_b)) return;
  keep_contacts();
  world_.set_link_collision(link_id(*a, link_a), link_id(*b, link_b), enabled);
}

void Client::set_collision_mask(int id, int link, int group, int mask) {
  Body* const body = find(id);
  if (body == nullptr || !body->has_link(link)) return;
  keep_contacts();
  body->of(link).filter = {group, mask};
  for (const int other : order_) {
    if (other == id) continue;
    for (int k = -1; k < num_joints(other); ++k) {
      world_.set_link_collision(link_id(*body, link), link_id(*find(other), k),
                                may_collide(*body, link, *find(other), k));
    }
  }
}

/// What rules and masses say of a body that is new.
void Client::apply_filters(int id) {
  Body& body = *find(id);
  const bool usual = std::ranges::all_of(body.memory, [&](const LinkMemory& memory) {
    return memory.filter == std::array{1, -1} || memory.filter == std::array{2, -3};
  });
  for (const int other_id : order_) {
    Body& other = *find(other_id);
    if (other_id == id) continue;
    for (int k = -1; k < other.plan.num_links(); ++k) {
      const auto& filter = other.of(k).filter;
      const bool is_usual = usual && (filter == std::array{1, -1} || filter == std::array{2, -3});
      if (is_usual) continue;
      for (int i = -1; i < body.plan.num_links(); ++i) {
        if (!may_collide(body, i, other, k)) world_.set_link_collision(link_id(body, i), link_id(other, k), false);
      }
    }
  }
  for (const auto& [key, enabled] : pair_rules_) {
    if (key[0] == id || key[2] == id) set_collision_pair(key[0], key[2], key[1], key[3], enabled);
  }
}

}  // namespace manyhands::bullet
