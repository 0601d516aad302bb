// manyhands._core.World: where bodies are, what pushes them, and what the last step found.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/model/model_values.h"
#include "bindings/world/world_parts.h"
#include "manyhands/physics/world/parameters.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::copied;
using bindings::Numbers3;
using bindings::Numbers4;
using bindings::returns_array;
using bindings::vec3;
using bindings::vector3;

constexpr const char* kArray = "numpy.typing.NDArray[numpy.float64]";
constexpr const char* kLike = "numpy.typing.ArrayLike";

/// A contact and the names of what touches.
struct NamedContact {
  Contact contact;
  std::string link_a, link_b, geom_a, geom_b;
};

nb::object vector6(const Force<double>& F) { return copied(&F.n.x, {6}); }

std::vector<NamedContact> named_contacts(const World& world) {
  std::vector<NamedContact> result;
  for (const Contact& contact : world.contacts()) {
    result.push_back({contact, world.link_name(contact.link_a), world.link_name(contact.link_b),
                      world.geom_name(contact.geom_a), world.geom_name(contact.geom_b)});
  }
  return result;
}

std::string pair_of_arrays(const std::string& head) { return head + " -> tuple[" + kArray + ", " + kArray + "]"; }

void bind_contact(nb::module_& m) {
  const auto vector = [](const char* name) { return returns_array(name); };
  nb::class_<NamedContact>(m, "Contact",
                           "A point where two links touched in a step, in world axes. Forces act on B, reversed on A.")
      .def_ro("link_a", &NamedContact::link_a, "The first of the two links that touch.")
      .def_ro("link_b", &NamedContact::link_b, "The second of the two links that touch.")
      .def_ro("geom_a", &NamedContact::geom_a, "Its name, or 'link#k' for the k-th nameless geom of a link.")
      .def_ro("geom_b", &NamedContact::geom_b, "The geom of link_b.")
      .def_prop_ro(
          "position", [](const NamedContact& c) { return vector3(c.contact.position); },
          nb::sig(vector("position").c_str()), "Midway between the surfaces, before the step (3) [m].")
      .def_prop_ro(
          "normal", [](const NamedContact& c) { return vector3(c.contact.normal); }, nb::sig(vector("normal").c_str()),
          "Unit, from A to B (3).")
      .def_prop_ro(
          "distance", [](const NamedContact& c) { return c.contact.distance; },
          "Along the normal, before the step; negative in penetration [m].")
      .def_prop_ro(
          "impulse", [](const NamedContact& c) { return vector3(c.contact.impulse); },
          nb::sig(vector("impulse").c_str()), "On B (3) [N s].")
      .def_prop_ro(
          "force", [](const NamedContact& c) { return vector3(c.contact.force); }, nb::sig(vector("force").c_str()),
          "On B: impulse / time_step (3) [N].")
      .def_prop_ro(
          "normal_force", [](const NamedContact& c) { return c.contact.normal_force; }, "Along the normal [N].")
      .def_prop_ro(
          "friction_force", [](const NamedContact& c) { return vector3(c.contact.friction_force); },
          nb::sig(vector("friction_force").c_str()), "On B, across the normal (3) [N].")
      .def_prop_ro(
          "moment", [](const NamedContact& c) { return vector3(c.contact.moment); }, nb::sig(vector("moment").c_str()),
          "Of spinning and rolling friction, on B (3) [N m].")
      .def("__repr__", [](const NamedContact& c) {
        return "<Contact '" + c.geom_a + "' - '" + c.geom_b + "': " + std::to_string(c.contact.normal_force) + " N, " +
               std::to_string(c.contact.distance) + " m>";
      });
  nb::class_<ContactWrench>(m, "ContactWrench",
                            "What contacts do to a link, torque first, in world axes about its origin as it was before "
                            "the step (6) [N m, N].")
      .def_prop_ro(
          "normal", [](const ContactWrench& w) { return vector6(w.normal); }, nb::sig(vector("normal").c_str()),
          "Of the normal forces (6).")
      .def_prop_ro(
          "friction", [](const ContactWrench& w) { return vector6(w.friction); }, nb::sig(vector("friction").c_str()),
          "Of friction, spinning and rolling included (6).")
      .def_prop_ro(
          "total", [](const ContactWrench& w) { return vector6(w.total()); }, nb::sig(vector("total").c_str()),
          "Both together (6).");
  nb::class_<ContactResiduals>(m, "ContactResiduals",
                               "How far the last step's contacts are from Signorini's and Coulomb's laws: the largest "
                               "over all points. u is B's velocity against A's at the step's end, its normal part less "
                               "the one that the point must have at least; (n, y) is the impulse.")
      .def_ro("signorini", &ContactResiduals::signorini, "|u_n| n [J].")
      .def_ro("penetration_rate", &ContactResiduals::penetration_rate, "max(0, -u_n) [m/s].")
      .def_ro("cone", &ContactResiduals::cone, "max(0, |y| - n) [N s], y in units of friction: |y| <= n is the cone.")
      .def_ro("dissipation", &ContactResiduals::dissipation,
              "|y - P(y - u_t / G)| G [m/s]: P onto the disc of radius n, G what resists sliding.")
      .def("__repr__", [](const ContactResiduals& r) {
        return "<ContactResiduals signorini " + std::to_string(r.signorini) + " J, penetration_rate " +
               std::to_string(r.penetration_rate) + " m/s, cone " + std::to_string(r.cone) + " N s, dissipation " +
               std::to_string(r.dissipation) + " m/s>";
      });
}

}  // namespace

void bind_world_contacts(nb::module_& m, nb::class_<World>& world) {
  bind_contact(m);
  world
      .def(
          "contacts", &named_contacts,
          "The points that touched in the last step, or carried an impulse; none before a step, and after `restore` or "
          "after parts came or went.")
      .def(
          "contact_wrench",
          [](const World& self, const std::string& link, const std::optional<std::string>& other) {
            return self.contact_wrench(link, other.value_or(""));
          },
          "link"_a, "other"_a = nb::none(),
          "What the last step's contacts do to a link; only those with the link `other`, if it is given.")
      .def(
          "joint_wrench", [](const World& self, const std::string& joint) { return vector6(self.joint_wrench(joint)); },
          "joint"_a, nb::sig("def joint_wrench(self, joint: str) -> numpy.typing.NDArray[numpy.float64]"),
          "What the joint transmitted to its child link in the last step, its motor's effort included: a wrist's "
          "force-torque sensor. Torque, force (6) [N m, N], in world axes about the child's origin as it was before "
          "the step; fixed joints have one too. Raises RuntimeError before a step, with 'rk4', or inside a closed "
          "loop.")
      .def("residuals", &World::residuals, "Of the contact law in the last step.")
      .def("max_penetration", &World::max_penetration, "Of the deepest contact, before the last step [m]; 0 if none.");
}

void bind_world_bodies(nb::class_<World>& world) {
  static const std::string pose = pair_of_arrays("def body_pose(self, name: str)");
  static const std::string all_poses = pair_of_arrays("def link_poses(self)");
  static const std::string velocity = pair_of_arrays("def body_velocity(self, name: str)");
  static const std::string set_pose = std::string("def set_body_pose(self, name: str, position: ") + kLike +
                                      ", quaternion: " + kLike + " = (0, 0, 0, 1)) -> None";
  static const std::string set_mocap = std::string("def set_mocap(self, link: str, position: ") + kLike +
                                       ", quaternion: " + kLike + " = (0, 0, 0, 1)) -> None";
  static const std::string set_velocity = std::string("def set_body_velocity(self, name: str, omega: ") + kLike +
                                          " = (0, 0, 0), velocity: " + kLike + " = (0, 0, 0)) -> None";
  static const std::string apply = std::string("def apply_force(self, name: str, force: ") + kLike +
                                   ", torque: " + kLike + " = (0, 0, 0), point: " + kLike + " | None = None) -> None";
  world
      .def(
          "body_pose",
          [](const World& self, const std::string& name) {
            const Transform<double> X = self.body_pose(name);
            return std::pair{vector3(X.p), bindings::quaternion(X.R)};
          },
          "name"_a, nb::sig(pose.c_str()), "Of a link or frame in the world: position (3) [m], quaternion xyzw (4).")
      .def(
          "link_poses",
          [](const World& self) {
            const std::span<const Link> links = self.model().links();
            std::vector<double> positions, quaternions;
            for (const Link& link : links) {
              const Transform<double> X = self.body_pose(link.name);
              const Quat<double> r = to_quat(X.R);
              positions.insert(positions.end(), {X.p.x, X.p.y, X.p.z});
              quaternions.insert(quaternions.end(), {r.x, r.y, r.z, r.w});
            }
            return std::pair{bindings::copied(positions.data(), {links.size(), 3}),
                             bindings::copied(quaternions.data(), {links.size(), 4})};
          },
          nb::sig(all_poses.c_str()), "Of all links of the model: positions (n, 3) [m], quaternions xyzw (n, 4).")
      .def(
          "body_velocity",
          [](const World& self, const std::string& name) {
            const Motion<double> V = self.body_velocity(name);
            return std::pair{vector3(V.w), vector3(V.v)};
          },
          "name"_a, nb::sig(velocity.c_str()),
          "Of a link or frame: angular (3) [rad/s], and that of its origin (3) [m/s], in world axes.")
      .def(
          "set_body_pose",
          [](World& self, const std::string& name, const Numbers3& position, const Numbers4& quaternion) {
            self.set_body_pose(name, bindings::transform("link '" + name + "'", position, quaternion));
          },
          "name"_a, "position"_a, "quaternion"_a = Numbers4{0, 0, 0, 1}, nb::sig(set_pose.c_str()),
          "Puts a free body, or a link that is fixed to the world, at position (3) [m] and quaternion xyzw (4). Raises "
          "ValueError for a link that hangs on another joint.")
      .def_prop_ro(
          "mocap",
          [](const World& self) {
            const std::span<const double> poses = self.mocap();
            return bindings::copied(poses.data(), {poses.size() / 7, 7});
          },
          nb::sig("def mocap(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Poses of the mocap bodies (n, 7): x y z [m], quaternion xyzw; see `Model.mocap_bodies`.")
      .def(
          "set_mocap",
          [](World& self, const std::string& link, const Numbers3& position, const Numbers4& quaternion) {
            self.set_mocap(link, bindings::transform("link '" + link + "'", position, quaternion));
          },
          "link"_a, "position"_a, "quaternion"_a = Numbers4{0, 0, 0, 1}, nb::sig(set_mocap.c_str()),
          "Puts a mocap body, at rest, at position (3) [m] and quaternion xyzw (4): it pushes what touches it, and "
          "pulls "
          "what is welded to it. Raises ValueError for other links.")
      .def(
          "set_body_velocity",
          [](World& self, const std::string& name, const Numbers3& w, const Numbers3& v) {
            self.set_body_velocity(name, {vec3(w), vec3(v)});
          },
          "name"_a, "omega"_a = Numbers3{}, "velocity"_a = Numbers3{}, nb::sig(set_velocity.c_str()),
          "Of a free body: omega (3) [rad/s] and the velocity of its origin (3) [m/s], in world axes. Raises "
          "ValueError "
          "for other links.")
      .def(
          "apply_force",
          [](World& self, const std::string& name, const Numbers3& force, const Numbers3& torque,
             const std::optional<Numbers3>& point) {
            self.apply_force(name, vec3(force), vec3(torque), point ? std::optional(vec3(*point)) : std::nullopt);
          },
          "name"_a, "force"_a, "torque"_a = Numbers3{}, "point"_a = nb::none(), nb::sig(apply.c_str()),
          "A force (3) [N] at `point` (3) [m], default the link's centre of mass, and a torque (3) [N m], in world "
          "axes; "
          "acts in the next step only. Forces add up.");
}

}  // namespace manyhands
