// Client: what its screen shows, and how people drag its links.
#include <utility>

#include "manyhands/bullet/client_body.h"
#include "manyhands/bullet/screen_frame.h"

namespace manyhands::bullet {

namespace {

/// Parts that were removed lie in the world's lists for a while, without a name.
bool is_there(const Link& link) { return !link.name.empty(); }

std::vector<std::string> names_of(std::span<const EqualityConstraint> equalities) {
  std::vector<std::string> names;
  for (const EqualityConstraint& equality : equalities) names.push_back(equality.name);
  return names;
}

/// The constraints by which a world's links are dragged.
std::vector<std::string> grips_in(const Model& model) {
  std::vector<std::string> names = names_of(model.equalities());
  std::erase_if(names, [](const std::string& name) { return !name.starts_with("grip "); });
  return names;
}

}  // namespace

ScreenFrame Client::frame(std::int64_t seen_items, std::int64_t seen_looks, bool with_model) {
  const Model& parts = world_.parts();
  ScreenFrame frame{.scene = scene_, .time = world_.time(), .looks = looks_};
  const std::span<const double> q = world_.q();
  frame.q.assign(q.begin(), q.end());
  for (std::size_t i = 0; i < parts.links().size(); ++i) {
    if (!is_there(parts.links()[i])) continue;
    const Transform<double> X_WL = world_.link_pose(LinkId(i));
    frame.positions.push_back(X_WL.p);
    frame.quaternions.push_back(to_quat(X_WL.R));
  }
  // To sweep removed parts out of the world itself, at a moment that chance chose, might change its bits.
  if (with_model) frame.model = World(world_).shared_model();
  if (with_model || seen_looks != looks_) {
    const Guise guise = guise_of(parts);
    for (std::size_t i = 0; i < parts.geoms().size(); ++i) {
      if (is_there(parts.link(parts.geoms()[i].link))) frame.rgba.push_back(guise.rgba[i]);
    }
  }
  if (screen_ != nullptr) show_items(seen_items, frame);
  return frame;
}

void Client::show_items(std::int64_t seen, ScreenFrame& frame) {
  Screen& screen = *screen_;
  screen.expire();
  frame.serial = screen.serial;
  for (const auto& [id, item] : screen.items) {
    const bool moves = item.parent[0] >= 0;
    const bool hides = moves && !has_link(item.parent[0], item.parent[1]);
    if (hides) continue;
    frame.ids.push_back(id);
    if (!moves && item.serial <= seen) continue;
    DebugItem& shown = frame.items.emplace_back(id, item).second;
    if (!moves) continue;
    const Transform<double> X_WI = inertial_pose(*find(item.parent[0]), item.parent[1]);
    for (Vec3<double>& point : shown.points) point = X_WI * point;
  }
  frame.screen.switches = screen.switches;
  frame.screen.background = screen.background;
  frame.screen.camera = screen.camera;
  frame.screen.camera_moves = screen.camera_moves;
  frame.screen.listens_to_keys = screen.listens_to_keys;
  frame.screen.listens_to_mouse = screen.listens_to_mouse;
}

bool Client::has_link(int id, int link) const {
  const Body* const body = find(id);
  return body != nullptr && body->has_link(link);
}

/// PyBullet's window drags bodies by a point-to-point constraint whose force is bounded; so does this one.
void Client::follow_grips(double h) {
  constexpr double kMostForce = 500;   // [N]
  constexpr double kFollowing = 0.05;  // [s]: pages tell of the mouse twenty times a second
  if (screen_->grips.empty()) return release_grips();
  const Model& model = world_.model();
  std::vector<EqualityConstraint> wanted;
  for (const Grip& grip : screen_->grips) {
    const LinkId link = model.find_link(grip.link);
    if (!link.is_valid()) continue;
    const Vec3<double> point = world_.link_pose(link) * grip.point;
    const Vec3<double> next = point + (h / (h + kFollowing)) * (grip.target - point);
    wanted.push_back({.name = "grip " + std::to_string(wanted.size()) + " of " + grip.link,
                      .link_a = link,
                      .link_b = LinkId(0),
                      .X_LA = {Mat3<double>::identity(), grip.point},
                      .X_LB = {Mat3<double>::identity(), next},
                      .max_force = kMostForce});
  }
  if (grips_in(model) != names_of(wanted)) {
    release_grips();
    keep_contacts();
    for (const EqualityConstraint& equality : wanted) world_.add_equality(equality);
    holds_ = true;
  }
  for (const EqualityConstraint& equality : wanted) world_.aim_equality(equality);
}

void Client::release_grips() {
  if (!std::exchange(holds_, false)) return;
  keep_contacts();
  for (const std::string& name : grips_in(world_.model())) world_.remove_equality(name);
}

}  // namespace manyhands::bullet
