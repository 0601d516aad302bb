// The robot element, its materials and its links' mass and surface.
#include <limits>

#include "manyhands/model/io/inertia_repair.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/io/urdf/urdf_parts.h"

namespace manyhands::io {

namespace {

std::string named(const char* kind, std::string_view name) {
  return std::string(kind) + " '" + std::string(name) + "'";
}

/// Stops at what xacro would have replaced; a <gazebo> block may hold anything.
void refuse_xacro(const UrdfElement& robot) {
  const std::string advice =
      "; this is a xacro file: run xacro first (xacro robot.urdf.xacro > robot.urdf) and load its output";
  std::vector<UrdfElement> stack{robot};
  while (!stack.empty()) {
    const UrdfElement element = stack.back();
    stack.pop_back();
    if (element.tag() == "gazebo") continue;
    if (element.tag().starts_with("xacro:")) element.fail("found <" + std::string(element.tag()) + ">" + advice);
    if (const auto leftover = element.attribute_with_substitution())
      element.fail("found " + in_quotes(*leftover) + advice);
    const std::vector<UrdfElement> children = element.children();
    stack.insert(stack.end(), children.rbegin(), children.rend());
  }
}

std::string robot_name(const UrdfElement& robot) {
  if (!robot.text_or_empty("name").empty()) return robot.text("name");
  robot.note(LoadAction::kDefaulted, "<robot> has no name; 'robot' taken");
  return "robot";
}

void note_unused(const UrdfElement& element) {
  const std::string_view tag = element.tag();
  const std::string_view name = element.text_or_empty("name");
  std::string text = "<" + std::string(tag) + ">";
  if (!name.empty()) text += " " + in_quotes(name);
  element.note(LoadAction::kIgnored, text + " is not used");
}

/// Robots cut from larger ones keep the mimics of joints that are gone.
void drop_mimics_of_nothing(UrdfRobot& robot, const std::map<std::string, int>& joint_lines) {
  for (UrdfJoint& joint : robot.joints) {
    std::optional<Mimic>& mimic = joint.joint.mimic;
    if (!mimic || joint_lines.contains(mimic->joint)) continue;
    joint.source.note_serious(LoadAction::kIgnored, "it mimics " + in_quotes(mimic->joint) +
                                                        ", which is no joint of the robot; it moves freely");
    mimic.reset();
  }
}

}  // namespace

UrdfRobot read_robot(const UrdfElement& robot) {
  refuse_xacro(robot);
  robot.expect({"name", "version"}, {"link", "joint", "material", "transmission", "gazebo"});
  UrdfRobot result;
  result.name = robot_name(robot);
  const Materials materials = read_materials(robot);
  std::map<std::string, int> link_lines, joint_lines;
  const auto claim = [](std::map<std::string, int>& lines, const UrdfElement& element, const std::string& name) {
    const auto [entry, is_new] = lines.emplace(name, element.line());
    if (!is_new) element.fail("the name is taken by line " + std::to_string(entry->second) + "; expected another name");
  };
  for (const UrdfElement& element : robot.children()) {
    if (element.tag() == "link") {
      const std::string name = element.text("name");
      const UrdfElement link = element.named(named("link", name));
      claim(link_lines, link, name);
      result.links.push_back(read_link(link, materials));
    } else if (element.tag() == "joint") {
      const std::string name = element.text("name");
      const UrdfElement joint = element.named(named("joint", name));
      claim(joint_lines, joint, name);
      result.joints.push_back(read_joint(joint));
    } else if (element.tag() == "transmission" || element.tag() == "gazebo") {
      note_unused(element);
    }
  }
  if (result.links.empty()) robot.fail("<robot> has no <link>; expected at least one");
  drop_mimics_of_nothing(result, joint_lines);
  return result;
}

std::optional<UrdfMaterial> read_material(const UrdfElement& material) {
  UrdfMaterial result{.rgba = {1, 1, 1, 1}};
  const UrdfElement color = material.child("color"), texture = material.child("texture");
  if (color) {
    color.expect({"rgba"});
    const std::vector<double> v = color.numbers("rgba", 4, "0.8 0.8 0.8 1");
    for (std::size_t i = 0; i < 4; ++i) result.rgba[i] = static_cast<float>(v[i]);
  }
  if (texture) {
    texture.expect({"filename"});
    result.texture_file = texture.text_or_empty("filename");  // exporters write an empty one for none
  }
  if (!color && result.texture_file.empty()) return std::nullopt;
  return result;
}

Materials read_materials(const UrdfElement& robot) {
  Materials materials;
  for (const UrdfElement& element : robot.children("material")) {
    const std::string name = element.text("name");
    const UrdfElement material = element.named(named("material", name));
    material.expect({"name"}, {"color", "texture"});
    const std::optional<UrdfMaterial> own = read_material(material);
    if (own && !materials.emplace(name, *own).second) {
      material.note(LoadAction::kIgnored, "there is a material of that name already; the first counts");
    }
  }
  for (const UrdfElement& link : robot.children("link")) {
    for (const UrdfElement& visual : link.children("visual")) {
      for (const UrdfElement& material : visual.children("material")) {
        const std::string_view name = material.text_or_empty("name");
        if (name.empty() || materials.contains(name)) continue;
        const std::optional<UrdfMaterial> own = read_material(material.named(named("material", name)));
        if (own) materials.emplace(name, *own);
      }
    }
  }
  return materials;
}

namespace {

/// Bullet's <inertia_scaling>.
void scale_inertia(const UrdfElement& source, UrdfLink& link) {
  const UrdfElement contact = source.child("contact");
  const UrdfElement scaling = contact ? contact.child("inertia_scaling") : contact;
  if (!scaling) return;
  const double factor = link.inertia_scale = scaling.number("value");
  if (!(factor > 0)) scaling.fail("<inertia_scaling> is not above 0");
  const SymMat3<double>& I = link.inertial.inertia;
  link.inertial.inertia = {factor * I.xx, factor * I.yy, factor * I.zz, factor * I.xy, factor * I.xz, factor * I.yz};
}

}  // namespace

UrdfLink read_link(const UrdfElement& link, const Materials& materials) {
  link.expect({"name"}, {"inertial", "visual", "collision", "contact"});
  UrdfLink result{.source = link, .name = link.text("name"), .inertial = read_inertial(link), .geoms = {}};
  if (const UrdfElement inertial = link.child("inertial")) result.inertial_axes = inertial.origin().R;
  if (link.is_bullet()) scale_inertia(link, result);
  const SurfaceMaterial surface = read_contact(link);
  const auto read_all = [&](const char* tag, GeomRole role) {
    for (const UrdfElement& element : link.children(tag)) {
      std::optional<UrdfGeom> geom = read_geom(element, role, materials);
      if (!geom) continue;
      geom->geom.surface = surface;
      result.geoms.push_back(std::move(*geom));
    }
  };
  read_all("visual", GeomRole::kVisual);
  read_all("collision", GeomRole::kCollision);
  return result;
}

namespace {

SymMat3<double> read_inertia(const UrdfElement& inertial) {
  const UrdfElement inertia = inertial.child("inertia");
  if (!inertia) {
    inertial.note(LoadAction::kDefaulted, "<inertial> has no <inertia>; 0 taken");
    return SymMat3<double>::zero();
  }
  inertia.expect({"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
  bool missing = false;
  const auto product = [&](const char* attribute) {
    const std::optional<double> value = inertia.optional_number(attribute);
    missing = missing || !value;
    return value.value_or(0.0);
  };
  const SymMat3<double> I{inertia.number("ixx"), inertia.number("iyy"), inertia.number("izz"),
                          product("ixy"),        product("ixz"),        product("iyz")};
  if (missing) inertia.note(LoadAction::kDefaulted, "<inertia> does not give all of ixy, ixz and iyz; 0 taken");
  return I;
}

}  // namespace

Inertial read_inertial(const UrdfElement& link) {
  const UrdfElement inertial = link.child("inertial");
  if (!inertial && link.is_bullet() && link.text("name") != "world") {
    link.note(LoadAction::kDefaulted, "no <inertial>; a mass of 1 kg and moments of inertia of 1 kg m^2 taken");
    return {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}};
  }
  if (!inertial) {
    link.note(LoadAction::kDefaulted, "no <inertial>; mass 0 taken");
    return {};
  }
  inertial.expect({}, {"origin", "mass", "inertia"});
  const UrdfElement mass = inertial.required_child("mass", "<mass value=\"1\"/>");
  mass.expect({"value"});
  const Transform<double> X_LC = inertial.origin();
  Inertial result{mass.number("value"), X_LC.p, rotated(X_LC.R, read_inertia(inertial))};
  const bool is_negative = result.mass < 0;
  if (const auto repair = repair_inertial(result)) {
    if (is_negative) {
      inertial.note_serious(LoadAction::kRepaired, *repair);
    } else {
      inertial.note(LoadAction::kRepaired, *repair);
    }
  }
  return result;
}

SurfaceMaterial read_contact(const UrdfElement& link) {
  SurfaceMaterial surface;
  const UrdfElement contact = link.child("contact");
  if (!contact) return surface;
  contact.expect({}, {"lateral_friction", "spinning_friction", "rolling_friction", "restitution", "stiffness",
                      "damping", link.is_bullet() ? "inertia_scaling" : "damping"});
  const auto read = [&](const char* tag,
                        double most = std::numeric_limits<double>::infinity()) -> std::optional<double> {
    const UrdfElement element = contact.child(tag);
    if (!element) return std::nullopt;
    element.expect({"value"});
    const double value = element.number("value");
    if (value >= 0 && value <= most) return value;
    const double taken = value < 0 ? 0.0 : most;
    element.note_serious(LoadAction::kRepaired, "<" + std::string(tag) + "> " + format_number(value) +
                                                    (value < 0 ? " is negative; " : " would make energy; ") +
                                                    format_number(taken) + " taken");
    return taken;
  };
  surface.lateral_friction = read("lateral_friction").value_or(surface.lateral_friction);
  surface.spinning_friction = read("spinning_friction").value_or(0.0);
  surface.rolling_friction = read("rolling_friction").value_or(0.0);
  surface.restitution = read("restitution", 1).value_or(0.0);
  surface.stiffness = read("stiffness");
  surface.damping = read("damping");
  return surface;
}

}  // namespace manyhands::io
