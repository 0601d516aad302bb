#include "manyhands/physics/world/parameters.h"

#include <algorithm>

#include "manyhands/model/part_checks.h"

namespace manyhands {

namespace {

template <class Names>
[[noreturn]] void throw_unknown(const std::string& what, std::string_view name, const Names& names) {
  std::string message = "there is no " + what + " '" + std::string(name) + "'; there are:";
  for (const std::string& known : names) message += " '" + known + "'";
  throw std::out_of_range(message);
}

}  // namespace

std::string geom_label(const Model& model, GeomId id) {
  const Geom& geom = model.geoms()[id.index()];
  if (!geom.name.empty()) return geom.name;
  int k = 0;
  for (const GeomId other : model.geoms_of(geom.link)) {
    if (other < id && model.geoms()[other.index()].name.empty()) ++k;
  }
  return model.link(geom.link).name + "#" + std::to_string(k);
}

GeomId geom_id(const Model& model, std::string_view label) {
  if (const GeomId named = model.find_geom(label); named.is_valid()) return named;
  std::vector<std::string> known;
  for (std::size_t i = 0; i < model.geoms().size(); ++i) {
    known.push_back(geom_label(model, GeomId(i)));
    if (known.back() == label) return GeomId(i);
  }
  throw_unknown("geom", label, known);
}

std::vector<GeomId> geoms_named(const Model& model, std::string_view name) {
  const LinkId link = model.find_link(name);
  if (!link.is_valid()) return {geom_id(model, name)};
  std::vector<GeomId> found;
  for (const GeomId id : model.geoms_of(link)) {
    if (model.geoms()[id.index()].role == GeomRole::kCollision) found.push_back(id);
  }
  if (found.empty()) throw std::out_of_range("link '" + std::string(name) + "' has no geom that collides");
  return found;
}

const Joint& moving_joint(const Model& model, std::string_view name) {
  const Joint& joint = model.joint(model.joint_id(name));
  if (joint.iv < 0) throw std::invalid_argument("joint '" + joint.name + "' is fixed: it has no such parameter");
  return joint;
}

ActuatorId actuator_id(const Model& model, std::string_view name) {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < model.actuators().size(); ++i) {
    known.push_back(model.actuators()[i].name);
    if (known.back() == name) return ActuatorId(i);
  }
  throw_unknown("actuator", name, known);
}

void require_at_least(const std::string& what, double least, double value) {
  if (is_finite(value) && value >= least) return;
  throw std::invalid_argument(what + " is " + std::to_string(value) + "; expected a finite number of " +
                              (least == 0 ? std::string("0") : std::to_string(least)) + " or more");
}

void require_gains(const Actuator& actuator, double kp) {
  if (actuator.type == ActuatorType::kForce) {
    throw std::invalid_argument("actuator '" + actuator.name + "' is a motor: it has no gains");
  }
  if (actuator.type == ActuatorType::kAffine) {
    throw std::invalid_argument("actuator '" + actuator.name + "' is affine: its gain and bias belong to the model");
  }
  if (actuator.type == ActuatorType::kVelocity && kp != 0) {
    throw std::invalid_argument("actuator '" + actuator.name + "' is a velocity drive: its kp must be 0");
  }
}

void require_link_mass(const Model& model, LinkId link, double mass) {
  const Link& part = model.link(link);
  const std::string what = "the mass of link '" + part.name + "'";
  if (!is_finite(mass) || !(mass > 0)) {
    throw std::invalid_argument(what + " is " + std::to_string(mass) + " kg; expected a finite number above 0");
  }
  if (!(part.inertial.mass > 0)) {
    throw std::invalid_argument(what + " cannot be set: it has none in the model, and so no inertia to scale");
  }
}

template <Real R>
void set_link_mass(const Model& model, LinkId link, double mass, const Strided<R>& link_mass,
                   const ParamsView<R>& params) {
  require_link_mass(model, link, mass);
  link_mass[link.index()] = static_cast<R>(mass);
  const BodyId body = model.link(link).body;
  RigidInertia<double> sum = RigidInertia<double>::zero();
  Lift lifted{.body = body};
  for (const LinkId id : model.links_of(body)) {
    const std::size_t i = id.index();
    const Link& part = model.links()[i];
    Inertial inertial = part.inertial;
    if (inertial.mass > 0) {
      const double factor = static_cast<double>(link_mass[i]) / inertial.mass;
      SymMat3<double>& I = inertial.inertia;
      I = {factor * I.xx, factor * I.yy, factor * I.zz, factor * I.xy, factor * I.xz, factor * I.yz};
      inertial.mass = static_cast<double>(link_mass[i]);
    }
    sum = sum + transformed(part.X_BL, inertial.about_origin());
    const double carried = part.gravity_compensation * inertial.mass;
    lifted.mass += carried;
    lifted.moment = lifted.moment + carried * (part.X_BL * inertial.com);
  }
  const std::array<double, 10> numbers{sum.m,    sum.h.x,  sum.h.y,  sum.h.z,  sum.I.xx,
                                       sum.I.yy, sum.I.zz, sum.I.xy, sum.I.xz, sum.I.yz};
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    params.inertia[10 * body.index() + k] = static_cast<R>(numbers[k]);
  }
  const auto lift = std::ranges::find(model.lifts(), body, &Lift::body);
  if (lift == model.lifts().end()) return;
  const auto i = static_cast<std::size_t>(lift - model.lifts().begin());
  const std::array<double, 3> moment{lifted.moment.x, lifted.moment.y, lifted.moment.z};
  params.lifted_mass[i] = static_cast<R>(lifted.mass);
  for (std::size_t k = 0; k < moment.size(); ++k) params.lifted_moment[3 * i + k] = static_cast<R>(moment[k]);
}

template void set_link_mass(const Model&, LinkId, double, const Strided<double>&, const ParamsView<double>&);
template void set_link_mass(const Model&, LinkId, double, const Strided<float>&, const ParamsView<float>&);

void require_shape_size(const std::string& what, const Shape& shape) {
  const std::array<double, 3> size{shape.size.x, shape.size.y, shape.size.z};
  for (std::size_t k = 0; k < num_sizes(shape.type); ++k) {
    const double number = size[k];
    if (is_finite(number) && number > 0) continue;
    throw std::invalid_argument(what + ": its size has " + std::to_string(number) +
                                " m; expected finite numbers above 0");
  }
}

void require_sized(const std::string& geom, const Shape& shape) {
  if (num_sizes(shape.type) == 0) {
    throw std::invalid_argument("geom '" + geom +
                                "' has no size: only spheres, capsules, cylinders and boxes have one");
  }
  require_shape_size("geom '" + geom + "'", shape);
}

}  // namespace manyhands
