// manyhands._core: the parts of a model, as Python reads them.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings/bindings.h"
#include "bindings/model/model_values.h"
#include "manyhands/model/part_checks.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::copied;
using bindings::name_of;
using bindings::quaternion;
using bindings::returns_array;
using bindings::vector3;

nb::object matrix(const SymMat3<double>& m) {
  const std::array rows{m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz};
  return copied(rows.data(), {3, 3});
}

nb::object numbers(const std::vector<double>& v) { return copied(v.data(), {v.size()}); }

void bind_compliance(nb::module_& m) {
  nb::class_<Compliance>(
      m, "Compliance",
      "How a constraint gives way instead of holding exactly: MuJoCo's solref and solimp. A row whose error is r and "
      "that moves by J v meets a force f with\n\n"
      "    d/dt (J v) + (1 - d) / d W f = -damping / d_max (J v) - stiffness / d_max^2 d r\n\n"
      "where W = J M^-1 J^T at the model's start, and the impedance d grows with |r| from impedance[0] at 0 to d_max = "
      "impedance[1] at `width`.")
      .def(
          "__init__",
          [](Compliance* self, double time_constant, double damping_ratio, std::optional<double> stiffness,
             std::optional<double> damping, const std::pair<double, double>& impedance, double width, double midpoint,
             double power, double share) {
            Compliance c = compliance_of(time_constant, damping_ratio);
            if (stiffness || damping) c = {.stiffness = stiffness.value_or(0), .damping = damping.value_or(0)};
            std::tie(c.impedance, c.largest_impedance) = impedance;
            c.width = width;
            c.midpoint = midpoint;
            c.power = power;
            c.share = share;
            check_compliance("a compliance", c);
            new (self) Compliance(c);
          },
          "time_constant"_a = 0.02, "damping_ratio"_a = 1.0, nb::kw_only(), "stiffness"_a = nb::none(),
          "damping"_a = nb::none(), "impedance"_a = std::pair{0.9, 0.95}, "width"_a = 0.001, "midpoint"_a = 0.5,
          "power"_a = 2.0, "share"_a = 1.0,
          "time_constant [s] and damping_ratio, as which it oscillates, give stiffness [1/s^2] and damping [1/s], "
          "where "
          "neither of these is given. width [m or rad]; the impedance follows x^power up to the midpoint of the width, "
          "then its mirror. share: of a surface, what it counts in the mean of two that touch. Raises ValueError.")
      .def_ro("stiffness", &Compliance::stiffness, "[1/s^2]")
      .def_ro("damping", &Compliance::damping, "[1/s]")
      .def_prop_ro(
          "impedance", [](const Compliance& c) { return std::pair(c.impedance, c.largest_impedance); },
          "Where the error is 0, and from `width` on.")
      .def_ro("width", &Compliance::width, "[m or rad]")
      .def_ro("midpoint", &Compliance::midpoint,
              "Share of the width up to which the impedance follows x^power, then its mirror.")
      .def_ro("power", &Compliance::power, "As `midpoint` says; 1: in proportion.")
      .def_ro("share", &Compliance::share, "Of a surface: what it counts in the mean of two that touch.")
      .def(
          "__eq__", [](const Compliance& a, const Compliance& b) { return a == b; }, nb::is_operator())
      .def("__repr__", [](const Compliance& c) {
        return "<Compliance: stiffness " + std::to_string(c.stiffness) + ", damping " + std::to_string(c.damping) + ">";
      });
}

void bind_links(nb::module_& m) {
  nb::class_<Link>(m, "Link", "A named rigid part. Its frame L is the frame of the joint that moves it, at q = 0.")
      .def_ro("name", &Link::name, "Unique among links and frames.")
      .def("__repr__", [](const Link& link) { return "<Link '" + link.name + "'>"; })
      .def_prop_ro(
          "mass", [](const Link& link) { return link.inertial.mass; }, "[kg]")
      .def_prop_ro(
          "com", [](const Link& link) { return vector3(link.inertial.com); }, nb::sig(returns_array("com").c_str()),
          "Centre of mass in L, (3) [m].")
      .def_prop_ro(
          "inertia", [](const Link& link) { return matrix(link.inertial.inertia); },
          nb::sig(returns_array("inertia").c_str()), "About the centre of mass in L's axes, (3, 3) [kg m^2].")
      .def_ro("gravity_compensation", &Link::gravity_compensation, "Share of its weight that is carried for it.")
      .def_prop_ro(
          "parent", [](const Link& link) { return link.parent.value(); }, "Index of the parent link; -1 for the world.")
      .def_prop_ro(
          "joint", [](const Link& link) { return link.joint.value(); }, "Index of the joint to it; -1 without one.")
      .def_prop_ro(
          "body", [](const Link& link) { return link.body.value(); },
          "The moving body that carries the link; links joined by fixed joints share one, 0 is the world.");

  nb::class_<Joint>(m, "Joint",
                    "Joins a child link to its parent P. Frame F is fixed in P; at q = 0 the child's frame "
                    "is F.")
      .def_ro("name", &Joint::name, "Unique among joints.")
      .def("__repr__", [](const Joint& joint) { return "<Joint '" + joint.name + "': " + to_string(joint.type) + ">"; })
      .def_prop_ro(
          "type", [](const Joint& joint) { return to_string(joint.type); },
          "'fixed', 'revolute', 'continuous', 'prismatic', 'spherical', 'planar', 'floating' or 'mocap'.")
      .def_prop_ro(
          "parent", [](const Joint& joint) { return joint.parent.value(); }, "Index of the parent link.")
      .def_prop_ro(
          "child", [](const Joint& joint) { return joint.child.value(); }, "Index of the child link.")
      .def_prop_ro(
          "position", [](const Joint& joint) { return vector3(joint.X_PF.p); },
          nb::sig(returns_array("position").c_str()), "Of F in P, (3) [m].")
      .def_prop_ro(
          "quaternion", [](const Joint& joint) { return quaternion(joint.X_PF.R); },
          nb::sig(returns_array("quaternion").c_str()), "Of F in P, xyzw (4).")
      .def_prop_ro(
          "axis", [](const Joint& joint) { return vector3(joint.axis); }, nb::sig(returns_array("axis").c_str()),
          "Unit axis in F (3); of a planar joint, the normal.")
      .def_prop_ro(
          "lower", [](const Joint& joint) { return joint.limits.lower; }, "[rad or m]; -inf without a limit.")
      .def_prop_ro(
          "upper", [](const Joint& joint) { return joint.limits.upper; }, "[rad or m]; inf without a limit.")
      .def_prop_ro(
          "effort", [](const Joint& joint) { return joint.limits.effort; }, "[N m or N]; inf without a limit.")
      .def_prop_ro(
          "velocity", [](const Joint& joint) { return joint.limits.velocity; }, "[rad/s or m/s]; inf without a limit.")
      .def_prop_ro(
          "compliance", [](const Joint& joint) { return joint.limits.compliance; },
          "How its limits give way; None where they hold exactly.")
      .def_ro("damping", &Joint::damping, "[N m s/rad or N s/m]")
      .def_ro("friction", &Joint::friction, "Dry friction [N m or N].")
      .def_ro("stiffness", &Joint::stiffness, "Of its spring [N m/rad or N/m]; 0 without one.")
      .def_ro("armature", &Joint::armature, "Rotor inertia seen at the joint [kg m^2 or kg].")
      .def_prop_ro(
          "nq", [](const Joint& joint) { return configuration_size(joint.type); }, "Coordinates in q.")
      .def_prop_ro(
          "nv", [](const Joint& joint) { return velocity_size(joint.type); }, "Coordinates in v.")
      .def_prop_ro(
          "initial", [](const Joint& joint) { return numbers(joint.initial); },
          nb::sig(returns_array("initial").c_str()), "Where it starts, in q; empty: at 0, or unturned.")
      .def_prop_ro(
          "spring_reference", [](const Joint& joint) { return numbers(joint.spring_reference); },
          nb::sig(returns_array("spring_reference").c_str()),
          "Where its spring is at rest, in q; empty: at 0, or unturned.")
      .def_ro("iq", &Joint::iq, "Where they start in q; -1 for fixed joints.")
      .def_ro("iv", &Joint::iv, "Where they start in v; -1 for fixed joints.");

  nb::class_<Frame>(m, "Frame", "A named pose on a body. Every link is one, by the same name and index.")
      .def_ro("name", &Frame::name, "Unique among links and frames.")
      .def("__repr__", [](const Frame& frame) { return "<Frame '" + frame.name + "'>"; })
      .def_prop_ro(
          "body", [](const Frame& frame) { return frame.body.value(); }, "The body that carries it; 0 is the world.");
}

void bind_geom(nb::module_& m) {
  nb::class_<Geom>(m, "Geom", "A shape on a link, seen or touched. Its frame G: along z where it has an axis.")
      .def_ro("name", &Geom::name, "May be empty.")
      .def("__repr__",
           [](const Geom& geom) {
             return "<Geom '" + geom.name + "': " + name_of(geom.shape.type, bindings::kShapes) + ">";
           })
      .def_prop_ro(
          "is_visual", [](const Geom& geom) { return geom.role == GeomRole::kVisual; }, "Seen, but touches nothing.")
      .def_prop_ro(
          "link", [](const Geom& geom) { return geom.link.value(); }, "Index of the link that carries it.")
      .def_prop_ro(
          "shape", [](const Geom& geom) { return name_of(geom.shape.type, bindings::kShapes); },
          "'sphere', 'capsule', 'cylinder', 'box', 'plane' (the half-space below z = 0), 'mesh', 'convex' (the hull of "
          "a "
          "mesh) or 'height_field'.")
      .def_prop_ro(
          "size", [](const Geom& geom) { return vector3(geom.shape.size); }, nb::sig(returns_array("size").c_str()),
          "(3) [m]: sphere: radius; capsule, cylinder: radius, half length; box: half extents; the rest is 0.")
      .def_prop_ro(
          "mesh", [](const Geom& geom) { return geom.shape.mesh.value(); }, "Index in `Model.meshes`; -1 without one.")
      .def_prop_ro(
          "height_field", [](const Geom& geom) { return geom.shape.height_field.value(); },
          "Index in `Model.height_fields`; -1 without one.")
      .def_prop_ro(
          "position", [](const Geom& geom) { return vector3(geom.X_LG.p); }, nb::sig(returns_array("position").c_str()),
          "Of G in the link's frame, (3) [m].")
      .def_prop_ro(
          "quaternion", [](const Geom& geom) { return quaternion(geom.X_LG.R); },
          nb::sig(returns_array("quaternion").c_str()), "Of G in the link's frame, xyzw (4).")
      .def_prop_ro(
          "friction", [](const Geom& geom) { return geom.surface.lateral_friction; },
          "Coefficient of sliding friction.")
      .def_prop_ro(
          "spinning_friction", [](const Geom& geom) { return geom.surface.spinning_friction; },
          "Torque about the normal per normal force [m].")
      .def_prop_ro(
          "rolling_friction", [](const Geom& geom) { return geom.surface.rolling_friction; },
          "Torque across the normal per normal force [m].")
      .def_prop_ro(
          "restitution", [](const Geom& geom) { return geom.surface.restitution; },
          "Share of the approaching speed that is given back.")
      .def_prop_ro(
          "compliance", [](const Geom& geom) { return geom.surface.compliance; },
          "How its surface gives way; None of a hard one.")
      .def_prop_ro(
          "group", [](const Geom& geom) { return geom.filter.group; },
          "Bits; two geoms may touch if each one's group is in the other's mask.")
      .def_prop_ro(
          "mask", [](const Geom& geom) { return geom.filter.mask; }, "Which groups it touches, bit by bit.")
      .def_ro("margin", &Geom::margin, "How far the surface is pushed outwards for contact [m].")
      .def_ro("rgba", &Geom::rgba, "Red, green, blue and opacity, 0 to 1.")
      .def_prop_ro(
          "texture",
          [](const Geom& geom) -> std::string {
            if (!geom.texture) return "";
            return geom.texture->file.empty() ? "checks" : geom.texture->file;
          },
          "The image file that it shows by itself, 'checks', or nothing.");

  nb::class_<Mesh>(m, "Mesh", "Triangles, shared by the geoms that show or use them.")
      .def_ro("source", &Mesh::source, "The file it came from, or a description.")
      .def("__repr__", [](const Mesh& mesh) { return "<Mesh '" + mesh.source + "'>"; })
      .def_prop_ro(
          "vertices", [](const Mesh& mesh) { return copied(&mesh.vertices.data()->x, {mesh.vertices.size(), 3}); },
          nb::sig("def vertices(self) -> numpy.typing.NDArray[numpy.float32]"), "(n, 3) [m].")
      .def_prop_ro(
          "triangles",
          [](const Mesh& mesh) { return copied(mesh.triangles.data()->data(), {mesh.triangles.size(), 3}); },
          nb::sig("def triangles(self) -> numpy.typing.NDArray[numpy.int32]"),
          "(n, 3) indices of vertices, counter-clockwise seen from outside.");

  nb::class_<HeightField>(m, "HeightField", "Heights on a grid in the xy plane, centred on its geom's origin.")
      .def("__repr__",
           [](const HeightField& field) {
             return "<HeightField of " + std::to_string(field.rows) + " x " + std::to_string(field.columns) +
                    " heights>";
           })
      .def_ro("dx", &HeightField::dx, "Spacing along x [m].")
      .def_ro("dy", &HeightField::dy, "Spacing along y [m].")
      .def_prop_ro(
          "heights",
          [](const HeightField& field) {
            return copied(field.height.data(),
                          {static_cast<std::size_t>(field.rows), static_cast<std::size_t>(field.columns)});
          },
          nb::sig(returns_array("heights").c_str()), "(rows along y, columns along x) [m].");
}

void bind_couplings(nb::module_& m) {
  nb::class_<Tendon>(
      m, "Tendon",
      "A length that follows from q, and the forces along it: of a spring, a damper, dry friction, limits "
      "and actuators.")
      .def_ro("name", &Tendon::name, "Unique among tendons.")
      .def("__repr__", [](const Tendon& t) { return "<Tendon '" + t.name + "'>"; })
      .def_prop_ro(
          "joints",
          [](const Tendon& t) {
            std::vector<std::pair<int, double>> parts;
            for (const TendonJoint& part : t.joints) parts.emplace_back(part.joint.value(), part.coefficient);
            return parts;
          },
          "Of a fixed tendon, whose length is the sum of coefficient q: (index of the joint, coefficient).")
      .def_prop_ro(
          "branches",
          [](const Tendon& t) {
            std::vector<std::pair<double, std::vector<std::pair<int, std::array<double, 3>>>>> branches;
            for (const TendonBranch& branch : t.branches) {
              branches.emplace_back(branch.divisor, std::vector<std::pair<int, std::array<double, 3>>>());
              for (const TendonPoint& point : branch.points)
                branches.back().second.emplace_back(point.link.value(),
                                                    std::array{point.p_L.x, point.p_L.y, point.p_L.z});
            }
            return branches;
          },
          "Of a spatial tendon, which runs from point to point: (divisor, [(index of the link, point in its frame "
          "[m])]).")
      .def_ro("lower", &Tendon::lower, "-inf without a limit.")
      .def_ro("upper", &Tendon::upper, "inf without a limit.")
      .def_ro("compliance", &Tendon::compliance, "How its limits give way; None where they hold exactly.")
      .def_ro("damping", &Tendon::damping, "Force per rate of length.")
      .def_ro("friction", &Tendon::friction, "Dry friction [N].")
      .def_ro("armature", &Tendon::armature, "Inertia that moves with the length [kg].")
      .def_ro("stiffness", &Tendon::stiffness, "Of a spring that pulls outside of spring_lower to spring_upper [N/m].")
      .def_ro("spring_lower", &Tendon::spring_lower, "Its spring acts below this length [m, or as q].")
      .def_ro("spring_upper", &Tendon::spring_upper, "Its spring acts above this length [m, or as q].");

  nb::class_<Actuator>(m, "Actuator", "A drive on a joint or tendon, commanded by one number, ctrl.")
      .def_ro("name", &Actuator::name, "Unique among actuators.")
      .def("__repr__",
           [](const Actuator& a) {
             return "<Actuator '" + a.name + "': " + name_of(a.type, bindings::kActuators) + ">";
           })
      .def_prop_ro(
          "type", [](const Actuator& a) { return name_of(a.type, bindings::kActuators); },
          "'force': force = gear ctrl; 'position': gear (kp (ctrl - gear q) - kd gear v); 'velocity': gear kd (ctrl - "
          "gear v).")
      .def_prop_ro(
          "joint", [](const Actuator& a) { return a.joint.value(); },
          "Index of the joint; -1 where it drives a tendon.")
      .def_prop_ro(
          "tendon", [](const Actuator& a) { return a.tendon.value(); },
          "Index of the tendon, whose length is q above; -1 where it drives a joint.")
      .def_prop_ro(
          "link", [](const Actuator& a) { return a.site ? a.site->link.value() : -1; },
          "Index of the link with the site that it pulls at; -1 where it drives a joint or tendon.")
      .def_prop_ro(
          "gain", [](const Actuator& a) { return a.gain; },
          "'affine': force = gear (gain . (1, gear q, gear v) ctrl + bias . (1, gear q, gear v)).")
      .def_prop_ro(
          "bias", [](const Actuator& a) { return a.bias; }, "(3), as `gain` says.")
      .def_prop_ro(
          "activation", [](const Actuator& a) { return name_of(a.activation.type, bindings::kActivations); },
          "What the law reads in the place of ctrl: 'integrator': d act / dt = ctrl; 'filter', 'filterexact': (ctrl - "
          "act) / time_constant; 'none': ctrl itself.")
      .def_ro("iact", &Actuator::iact, "Index of its activation in act; -1 without one.")
      .def_prop_ro(
          "time_constant", [](const Actuator& a) { return a.activation.time_constant; }, "Of its activation [s].")
      .def_prop_ro(
          "act_range", [](const Actuator& a) { return std::pair{a.activation.lower, a.activation.upper}; },
          "Within which its activation stays.")
      .def_ro("ctrl_scale", &Actuator::ctrl_scale, "ctrl_scale ctrl + ctrl_offset stands for ctrl above.")
      .def_ro("ctrl_offset", &Actuator::ctrl_offset, "As `ctrl_scale` says.")
      .def_ro("gear", &Actuator::gear, "What laws multiply q, v and the force by.")
      .def_ro("kp", &Actuator::kp, "[N m/rad or N/m]")
      .def_ro("kd", &Actuator::kd, "[N m s/rad or N s/m]")
      .def_ro("min_ctrl", &Actuator::min_ctrl, "Commands below are taken as this.")
      .def_ro("max_ctrl", &Actuator::max_ctrl, "Commands above are taken as this.")
      .def_ro("max_force", &Actuator::max_force, "At the joint [N m or N]; inf without a limit.")
      .def_prop_ro("min_force", &Actuator::least_force, "-max_force unless the bounds differ.");

  nb::class_<Sensor>(m, "Sensor", "What a scene measures by name: MuJoCo's kinds and values, quaternions xyzw.")
      .def_ro("name", &Sensor::name, "Unique among sensors.")
      .def("__repr__", [](const Sensor& s) { return "<Sensor '" + s.name + "': " + to_string(s.type) + ">"; })
      .def_prop_ro(
          "type", [](const Sensor& s) { return to_string(s.type); }, "MuJoCo's name for it: 'jointpos', 'gyro' ...")
      .def_prop_ro(
          "size", [](const Sensor& s) { return size_of(s.type); }, "How many numbers it gives.")
      .def_prop_ro(
          "joint", [](const Sensor& s) { return s.joint.value(); }, "Index of the joint; -1 for others.")
      .def_prop_ro(
          "tendon", [](const Sensor& s) { return s.tendon.value(); }, "Index of the tendon; -1 for others.")
      .def_prop_ro(
          "actuator", [](const Sensor& s) { return s.actuator.value(); }, "Index of the actuator; -1 for others.")
      .def_prop_ro(
          "link", [](const Sensor& s) { return s.link.value(); }, "Index of the link that carries it; -1 for others.")
      .def_ro("cutoff", &Sensor::cutoff, "Numbers stay within it; 0 where there is none.");

  nb::class_<EqualityConstraint>(m, "EqualityConstraint",
                                 "An equation between two links, two joints or two tendons that always holds.")
      .def_ro("name", &EqualityConstraint::name, "Unique among equality constraints.")
      .def("__repr__",
           [](const EqualityConstraint& l) {
             return "<EqualityConstraint '" + l.name + "': " + name_of(l.type, bindings::kEqualities) + ">";
           })
      .def_prop_ro(
          "type", [](const EqualityConstraint& l) { return name_of(l.type, bindings::kEqualities); },
          "'point', 'hinge', 'fixed', 'prismatic' or 'slider', of links; 'joint' or 'gear', of joints; 'tendon'.")
      .def_prop_ro(
          "link_a", [](const EqualityConstraint& l) { return l.link_a.value(); }, "Index; -1 where joints are coupled.")
      .def_prop_ro(
          "link_b", [](const EqualityConstraint& l) { return l.link_b.value(); }, "Index; -1 where joints are coupled.")
      .def_prop_ro(
          "position_a", [](const EqualityConstraint& l) { return vector3(l.X_LA.p); },
          nb::sig(returns_array("position_a").c_str()), "Of frame A on link_a, (3) [m].")
      .def_prop_ro(
          "quaternion_a", [](const EqualityConstraint& l) { return quaternion(l.X_LA.R); },
          nb::sig(returns_array("quaternion_a").c_str()), "xyzw (4).")
      .def_prop_ro(
          "position_b", [](const EqualityConstraint& l) { return vector3(l.X_LB.p); },
          nb::sig(returns_array("position_b").c_str()), "Of frame B on link_b, (3) [m].")
      .def_prop_ro(
          "quaternion_b", [](const EqualityConstraint& l) { return quaternion(l.X_LB.R); },
          nb::sig(returns_array("quaternion_b").c_str()), "xyzw (4).")
      .def_prop_ro(
          "joint_a", [](const EqualityConstraint& l) { return l.joint_a.value(); }, "Index; -1 where links are joined.")
      .def_prop_ro(
          "joint_b", [](const EqualityConstraint& l) { return l.joint_b.value(); }, "Index; -1 where links are joined.")
      .def_prop_ro(
          "tendon_a", [](const EqualityConstraint& l) { return l.tendon_a.value(); },
          "Index; -1 of other types, and where tendon_b has one length.")
      .def_prop_ro(
          "tendon_b", [](const EqualityConstraint& l) { return l.tendon_b.value(); }, "Index; -1 of other types.")
      .def_ro("polynomial", &EqualityConstraint::polynomial,
              "'tendon': length_b - reference_b is this polynomial of length_a - reference_a; powers 0 to 4.")
      .def_ro("reference_a", &EqualityConstraint::reference_a, "Where q of a counts from [m or rad].")
      .def_ro("reference_b", &EqualityConstraint::reference_b, "Where q of b counts from [m or rad].")
      .def_ro("ratio", &EqualityConstraint::ratio, "'joint': q_b = ratio q_a + offset; 'gear': v_b = ratio v_a.")
      .def_ro("offset", &EqualityConstraint::offset, "[rad or m]")
      .def_ro("max_force", &EqualityConstraint::max_force, "Of each row [N or N m]; inf without a limit.")
      .def_ro("compliance", &EqualityConstraint::compliance, "How it gives way; None where it holds exactly.")
      .def_ro("torque_scale", &EqualityConstraint::torque_scale,
              "Half of it is how a rotation counts beside a displacement where it gives way [m/rad].");

  nb::class_<ContactPair>(m, "ContactPair", "Two geoms that may touch whatever their groups, masks and links say.")
      .def_prop_ro(
          "geom_a", [](const ContactPair& pair) { return pair.a.value(); }, "Index in `Model.geoms`.")
      .def_prop_ro(
          "geom_b", [](const ContactPair& pair) { return pair.b.value(); }, "Index in `Model.geoms`.")
      .def_prop_ro(
          "friction",
          [](const ContactPair& pair) -> std::optional<std::tuple<double, double, double>> {
            if (!pair.surface) return std::nullopt;
            const SurfaceMaterial& s = *pair.surface;
            return std::tuple(s.lateral_friction, s.spinning_friction, s.rolling_friction);
          },
          "(sliding, spinning [m], rolling [m]); None: what the geoms' own combine to.");

  nb::class_<Keyframe>(m, "Keyframe", "A state that a scene was given a name for.")
      .def_ro("name", &Keyframe::name, "Unique among keyframes.")
      .def("__repr__", [](const Keyframe& key) { return "<Keyframe '" + key.name + "'>"; })
      .def_ro("time", &Keyframe::time, "[s]")
      .def_prop_ro(
          "q", [](const Keyframe& key) { return numbers(key.q); }, nb::sig(returns_array("q").c_str()), "(nq)")
      .def_prop_ro(
          "v", [](const Keyframe& key) { return numbers(key.v); }, nb::sig(returns_array("v").c_str()), "(nv)")
      .def_prop_ro(
          "mocap", [](const Keyframe& key) { return copied(key.mocap.data(), {key.mocap.size() / 7, 7}); },
          nb::sig(returns_array("mocap").c_str()), "Of the mocap bodies: x y z [m], quaternion xyzw, (n, 7).")
      .def_prop_ro(
          "ctrl", [](const Keyframe& key) { return numbers(key.ctrl); }, nb::sig(returns_array("ctrl").c_str()), "(nu)")
      .def_prop_ro(
          "act", [](const Keyframe& key) { return numbers(key.act); }, nb::sig(returns_array("act").c_str()), "(na)");
}

}  // namespace

void bind_model_parts(nb::module_& m) {
  bind_compliance(m);
  bind_links(m);
  bind_geom(m);
  bind_couplings(m);
}

}  // namespace manyhands
