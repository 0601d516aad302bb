// WorldCore: what survives from one to the next.
#include <algorithm>
#include <limits>

#include "manyhands/physics/world/world_core.h"

namespace manyhands {

namespace {

constexpr auto kGone = std::numeric_limits<std::size_t>::max();

/// Copies a joint's items of every field that has one for each of `each`, from index i on to index k on.
template <class Fields>
void copy_items(const Fields& from, Fields& to, Each each, int i, int k, int count) {
  Fields::visit_fields(
      [&](const FieldInfo& info, const auto& a, auto& b) {
        if (info.each == each) std::copy_n(a.begin() + i, count, b.begin() + k);
      },
      from, to);
}

void carry_joint(const WorldCore& from, const Joint& a, const Joint& b, WorldCore& to) {
  if (a.type == JointType::kMocap) {
    const auto first = [](const WorldCore& core, const Joint& joint) {
      return static_cast<int>(kPoseNumbers * core.model->mocap_index(core.model->link(joint.child).name));
    };
    const int count = static_cast<int>(kPoseNumbers);
    copy_items(from.state, to.state, Each::kMocapNumber, first(from, a), first(to, b), count);
  }
  const int nq = configuration_size(a.type), nv = velocity_size(a.type);
  if (nv == 0) return;
  copy_items(from.state, to.state, Each::kCoordinate, a.iq, b.iq, nq);
  copy_items(from.state, to.state, Each::kDof, a.iv, b.iv, nv);
  copy_items(from.params, to.params, Each::kCoordinate, a.iq, b.iq, nq);
  copy_items(from.params, to.params, Each::kDof, a.iv, b.iv, nv);
}

/// Inertias of bodies follow the masses of their links.
void carry_links(const WorldCore& from, const std::vector<int>& links, WorldCore& to) {
  const WorldView<double> view = to.view(0);
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i] < 0) continue;
    const auto k = static_cast<std::size_t>(links[i]);
    to.extras.external[k] = from.extras.external[i];
    const double mass = from.extras.link_mass[i];
    if (to.extras.link_mass[k] != mass) set_link_mass(*to.model, LinkId(k), mass, view.extras.link_mass, view.params);
  }
  to.extras.pushed[0] = from.extras.pushed[0];
}

void carry_geoms(const WorldCore& from, const std::vector<int>& geoms, WorldCore& to) {
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    if (geoms[i] >= 0) copy_items(from.params, to.params, Each::kGeom, static_cast<int>(i), geoms[i], 1);
  }
}

void carry_actuators(const WorldCore& from, const std::vector<int>& actuators, WorldCore& to) {
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    if (actuators[i] < 0) continue;
    copy_items(from.state, to.state, Each::kActuator, static_cast<int>(i), actuators[i], 1);
    copy_items(from.params, to.params, Each::kActuator, static_cast<int>(i), actuators[i], 1);
    const int act = from.model->actuators()[i].iact;
    if (act < 0) continue;
    const int place = to.model->actuators()[static_cast<std::size_t>(actuators[i])].iact;
    copy_items(from.state, to.state, Each::kActivation, act, place, 1);
  }
}

void carry_tendons(const WorldCore& from, const std::vector<int>& tendons, WorldCore& to) {
  for (std::size_t i = 0; i < tendons.size(); ++i) {
    if (tendons[i] >= 0) copy_items(from.params, to.params, Each::kTendon, static_cast<int>(i), tendons[i], 1);
  }
}

/// Impulses of pairs whose geoms are both still there.
void carry_contacts(const WorldCore& from, const std::vector<int>& geoms, WorldCore& to) {
  std::vector<CachedContact> kept;
  for (CachedContact& contact : from.cached_contacts()) {
    for (std::size_t* collider : {&contact.low, &contact.high}) {
      const int geom = geoms[from.system.colliders.geoms[*collider].geom];
      *collider =
          geom < 0 ? kGone : static_cast<std::size_t>(to.system.colliders.collider_of[static_cast<std::size_t>(geom)]);
    }
    if (contact.low == kGone || contact.high == kGone) continue;
    if (contact.low > contact.high) std::swap(contact.low, contact.high);
    kept.push_back(contact);
  }
  to.cache_contacts(kept);
}

}  // namespace

void carry(const WorldCore& from, const PartMap& map, WorldCore& to) {
  copy_items(from.params, to.params, Each::kWorld, 0, 0, 1);
  for (std::size_t i = 0; i < map.joints.size(); ++i) {
    if (map.joints[i] < 0) continue;
    carry_joint(from, from.model->joints()[i], to.model->joints()[static_cast<std::size_t>(map.joints[i])], to);
  }
  carry_links(from, map.links, to);
  carry_geoms(from, map.geoms, to);
  carry_actuators(from, map.actuators, to);
  carry_tendons(from, map.tendons, to);
  carry_contacts(from, map.geoms, to);
  let_resist_turning(view(to.params, 0), to.system.colliders);
}

}  // namespace manyhands
