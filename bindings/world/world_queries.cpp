// manyhands._core.World: how far links are from each other, and what rays meet.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <limits>

#include "bindings/model/model_values.h"
#include "bindings/world/poses.h"
#include "bindings/world/world_parts.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/world/parameters.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::copied;
using bindings::Numbers;
using bindings::returns_array;
using bindings::vector3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct NamedDistance {
  ShapeDistance<double> surfaces;
  std::string link_a, link_b, geom_a, geom_b;
};

struct NamedHit {
  WorldRayHit hit;
  std::string link, geom;
};

/// Hits of many rays, row by row.
struct RayHits {
  std::vector<double> distance{};
  std::vector<Vec3<double>> point{}, normal{};
  std::vector<std::optional<std::string>> link{}, geom{};
};

NamedDistance named(const World& world, const LinkDistance& d) {
  return {d.surfaces, world.link_name(d.link_a), world.link_name(d.link_b), world.geom_name(d.geom_a),
          world.geom_name(d.geom_b)};
}

RayHits rows_of_hits(const World& world, const std::vector<std::optional<WorldRayHit>>& hits) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  RayHits rows;
  for (const auto& hit : hits) {
    rows.distance.push_back(hit ? hit->distance : kInfinity);
    rows.point.push_back(hit ? hit->point : Vec3<double>{kNone, kNone, kNone});
    rows.normal.push_back(hit ? hit->normal : Vec3<double>{kNone, kNone, kNone});
    rows.link.push_back(hit ? std::optional(world.link_name(hit->link)) : std::nullopt);
    rows.geom.push_back(hit ? std::optional(world.geom_name(hit->geom)) : std::nullopt);
  }
  return rows;
}

Numbers numbers(const nb::object& values) {
  return nb::cast<Numbers>(nb::module_::import_("numpy").attr("asarray")(values, "float64", "C"));
}

/// One ray; rays in rows are left to the next overload.
std::optional<NamedHit> cast_ray(const World& world, const nb::object& origin, const nb::object& direction,
                                 double max_distance) {
  const Numbers o = numbers(origin), d = numbers(direction);
  if (o.ndim() != 1 || d.ndim() != 1) throw nb::next_overload();
  const auto hit =
      world.ray_cast(bindings::vectors("origin", o), bindings::vectors("direction", d), max_distance).front();
  if (!hit) return {};
  return NamedHit{*hit, world.link_name(hit->link), world.geom_name(hit->geom)};
}

RayHits cast_rays(const World& world, const nb::object& origin, const nb::object& direction, double max_distance) {
  std::vector<Vec3<double>> o = bindings::vectors("origin", numbers(origin));
  std::vector<Vec3<double>> d = bindings::vectors("direction", numbers(direction));
  if (o.size() == 1) o.resize(d.size(), o[0]);
  if (d.size() == 1) d.resize(o.size(), d[0]);
  return rows_of_hits(world, world.ray_cast(o, d, max_distance));
}

nb::object matrix3(const std::vector<Vec3<double>>& rows) {
  return copied(reinterpret_cast<const double*>(rows.data()), {rows.size(), 3});
}

void bind_distance(nb::module_& m) {
  nb::class_<NamedDistance>(m, "LinkDistance", "The nearest surfaces of two links, or the deepest where they overlap.")
      .def_ro("link_a", &NamedDistance::link_a)
      .def_ro("link_b", &NamedDistance::link_b)
      .def_ro("geom_a", &NamedDistance::geom_a, "Its name, or 'link#k' for the k-th nameless geom of a link.")
      .def_ro("geom_b", &NamedDistance::geom_b)
      .def_prop_ro(
          "phi", [](const NamedDistance& d) { return d.surfaces.phi; }, "[m], negative in penetration.")
      .def_prop_ro(
          "point_a", [](const NamedDistance& d) { return vector3(d.surfaces.p_A); },
          nb::sig(returns_array("point_a").c_str()), "On A's surface, world (3) [m].")
      .def_prop_ro(
          "point_b", [](const NamedDistance& d) { return vector3(d.surfaces.p_B); },
          nb::sig(returns_array("point_b").c_str()), "On B's surface, world (3) [m].")
      .def_prop_ro(
          "normal", [](const NamedDistance& d) { return vector3(d.surfaces.normal_AB); },
          nb::sig(returns_array("normal").c_str()), "Unit, from A to B, world axes (3).")
      .def("__repr__", [](const NamedDistance& d) {
        return "<LinkDistance '" + d.geom_a + "' - '" + d.geom_b + "': " + std::to_string(d.surfaces.phi) + " m>";
      });
}

void bind_hits(nb::module_& m) {
  nb::class_<Finding>(m, "Finding", "What `World.diagnose` noticed.")
      .def_ro("kind", &Finding::kind,
              "'no_step', 'gravity', 'no_shape', 'no_ground', 'weak_motor' or 'target_beyond_limit'.")
      .def_ro("parts", &Finding::parts, "Names of links or joints.")
      .def_ro("text", &Finding::text, "A sentence that says what to do.")
      .def("__repr__", [](const Finding& finding) { return "<" + finding.kind + ": " + finding.text + ">"; });
  nb::class_<NamedHit>(m, "RayHit", "The first geom on a ray.")
      .def_ro("link", &NamedHit::link)
      .def_ro("geom", &NamedHit::geom, "Its name, or 'link#k' for the k-th nameless geom of a link.")
      .def_prop_ro(
          "distance", [](const NamedHit& h) { return h.hit.distance; }, "Along the ray [m].")
      .def_prop_ro(
          "point", [](const NamedHit& h) { return vector3(h.hit.point); }, nb::sig(returns_array("point").c_str()),
          "World (3) [m].")
      .def_prop_ro(
          "normal", [](const NamedHit& h) { return vector3(h.hit.normal); }, nb::sig(returns_array("normal").c_str()),
          "Unit, of the surface, against the ray, world axes (3).")
      .def("__repr__",
           [](const NamedHit& h) { return "<RayHit '" + h.geom + "' at " + std::to_string(h.hit.distance) + " m>"; });
  nb::class_<RayHits>(m, "RayHits", "The first geom on each of n rays.")
      .def("__repr__",
           [](const RayHits& h) {
             const auto hits = std::ranges::count_if(h.link, [](const auto& link) { return link.has_value(); });
             return "<RayHits: " + std::to_string(hits) + " of " + std::to_string(h.link.size()) + " rays>";
           })
      .def_ro("link", &RayHits::link, "(n) None for a miss.")
      .def_ro("geom", &RayHits::geom, "(n) None for a miss.")
      .def_prop_ro(
          "distance", [](const RayHits& h) { return copied(h.distance.data(), {h.distance.size()}); },
          nb::sig(returns_array("distance").c_str()), "Along the rays (n) [m], infinite for a miss.")
      .def_prop_ro(
          "point", [](const RayHits& h) { return matrix3(h.point); }, nb::sig(returns_array("point").c_str()),
          "World (n, 3) [m], NaN for a miss.")
      .def_prop_ro(
          "normal", [](const RayHits& h) { return matrix3(h.normal); }, nb::sig(returns_array("normal").c_str()),
          "Unit, against the rays, world axes (n, 3), NaN for a miss.");
}

}  // namespace

void bind_world_queries(nb::module_& m, nb::class_<World>& world) {
  bind_distance(m);
  bind_hits(m);
  world
      .def(
          "distance",
          [](const World& self, const std::string& a, const std::string& b) -> std::optional<NamedDistance> {
            const auto d = self.distance(a, b);
            if (!d) return {};
            return named(self, *d);
          },
          "link_a"_a, "link_b"_a,
          "Between the surfaces of two links, whether or not they may touch, in the present state. None if one of them "
          "has no colliding geom.")
      .def(
          "near_links",
          [](const World& self, double distance, const std::optional<std::string>& link) {
            std::vector<NamedDistance> result;
            for (const LinkDistance& d : link ? self.near_links(distance, *link) : self.near_links(distance)) {
              result.push_back(named(self, d));
            }
            return result;
          },
          "distance"_a, "link"_a = nb::none(),
          "Every two links that may touch and are less than `distance` [m] apart; only those with `link`, which takes "
          "a "
          "fraction of the time, if it is given.")
      .def(
          "diagnose", &World::diagnose,
          "What commonly goes wrong, if it does here: that no step was taken, that gravity is zero; free bodies "
          "without a shape, or that fall with nothing below; motors that give all they may and still cannot hold their "
          "joint, or are to go beyond its limits. The world does not change.")
      .def("ray_cast", &cast_ray, "origin"_a, "direction"_a, "max_distance"_a = kInfinity,
           nb::sig("def ray_cast(self, origin: collections.abc.Sequence[float], "
                   "direction: collections.abc.Sequence[float], max_distance: float = ...) -> RayHit | None"),
           "The first colliding geom on the ray from origin (3) [m] along direction (3), of any length above 0, no "
           "farther than max_distance [m]; None if there is none.")
      .def("ray_cast", &cast_rays, "origin"_a, "direction"_a, "max_distance"_a = kInfinity,
           nb::sig("def ray_cast(self, origin: numpy.typing.ArrayLike, direction: numpy.typing.ArrayLike, "
                   "max_distance: float = ...) -> RayHits"),
           "The same for rays (n, 3), either of them one for all.");
}

}  // namespace manyhands
