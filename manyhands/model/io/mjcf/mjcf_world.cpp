// <worldbody>: its bodies, with the mass that they have or that follows from their geoms.
#include <algorithm>

#include "manyhands/model/io/inertia_repair.h"
#include "manyhands/model/io/mjcf/mjcf_inertia.h"
#include "manyhands/model/io/mjcf/mjcf_scene.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/part_checks.h"
#include "manyhands/model/principal_axes.h"

namespace manyhands::io {

std::string claim_name(MjcfNames& names, const MjcfElement& element, const char* kind, std::size_t index,
                       const std::set<std::string, std::less<>>& reserved) {
  std::string name = element.text_or("name", "");
  if (name.empty()) {
    name = std::string(kind) + "_" + std::to_string(index);
    while (reserved.contains(name) || names.contains(name)) name += '_';
  }
  const auto [entry, is_new] = names.emplace(name, static_cast<int>(index));
  if (!is_new) {
    element.fail("the name " + in_quotes(name) + " is taken by another " + kind + "; expected another name");
  }
  return name;
}

namespace {

/// What lies in a body, by kind; the contents of <frame> elements belong to the body around them.
struct Contents {
  std::vector<MjcfPlaced> joints, geoms, sites, bodies, inertials;
};

class WorldReader {
 public:
  explicit WorldReader(MjcfScene& scene) : scene_(scene) {}

  void read() {
    scene_.bodies.push_back({.name = "world", .link = scene_.builder.world(), .X_WB = Transform<double>::identity()});
    scene_.body_names.emplace("world", 0);
    Contents contents;
    for (const MjcfElement& section : scene_.root.children("worldbody")) {
      const MjcfElement world = section.named("worldbody");
      world.expect({}, kContents);
      collect(world, Transform<double>::identity(), contents);
    }
    if (!contents.joints.empty()) contents.joints[0].element.fail("the world cannot have joints");
    read_contents(0, contents);
  }

 private:
  static constexpr std::array<std::string_view, 10> kContents{
      "body", "geom", "site", "frame", "joint", "freejoint", "inertial", "replicate", "flexcomp", "composite"};
  static constexpr int kMostReplicas = 100'000;

  void collect(const MjcfElement& around, const Transform<double>& X_BF, Contents& contents) {
    for (const MjcfElement& element : around.children()) {
      const std::string_view tag = element.tag();
      if (tag == "frame") {
        const MjcfElement frame = element.named("frame in " + around.what());
        frame.expect({"name", "childclass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"}, kContents);
        collect(frame, X_BF * read_pose(frame, scene_.settings_of(frame)), contents);
      } else if (tag == "replicate") {
        replicate(element.named("replicate in " + around.what()), X_BF, contents);
      } else if (tag == "joint" || tag == "freejoint") {
        contents.joints.push_back({element, X_BF});
      } else if (tag == "geom") {
        contents.geoms.push_back({element, X_BF});
      } else if (tag == "site") {
        contents.sites.push_back({element, X_BF});
      } else if (tag == "body") {
        contents.bodies.push_back({element, X_BF});
      } else if (tag == "inertial") {
        contents.inertials.push_back({element, X_BF});
      } else if (tag == "flexcomp" || tag == "composite") {
        element.named(std::string(tag) + " in " + around.what())
            .note_serious(LoadAction::kIgnored, "the bodies that it makes are left out");
      }
    }
  }

  /// Copies of what is in the element, numbers behind their names. Copy i is turned by i times the Euler angles; the
  /// offset to the next is in its axes.
  void replicate(const MjcfElement& element, const Transform<double>& X_BF, Contents& contents) {
    element.expect({"count", "offset", "euler", "sep", "childclass"}, kContents);
    const int count = element.integer_or("count", 0);
    if (count < 1 || count > kMostReplicas)
      element.fail("count is " + std::to_string(count) + "; expected 1 to 100000");
    const Vec3<double> offset = element.vec3_or("offset", Vec3<double>::zero());
    const Vec3<double> euler = element.vec3_or("euler", Vec3<double>::zero());
    Vec3<double> place = Vec3<double>::zero();
    for (int i = 0; i < count; ++i) {
      if (++num_replicas_ > kMostReplicas) element.fail("more than 100000 replicas in all; expected fewer");
      std::string number = std::to_string(i);
      const Mat3<double> R = rotation_from_euler(static_cast<double>(i) * euler, scene_.settings_of(element));
      number.insert(0, std::to_string(count).size() - number.size(), '0');
      collect(element.with_suffix(element.text_or("sep", "") + number), X_BF * Transform<double>{R, place}, contents);
      place = place + R * offset;
    }
  }

  /// To Bullet a body is turned by 'quat' alone.
  Transform<double> bullets_pose(const MjcfElement& body) const {
    const Vec3<double> p = body.vec3_or("pos", Vec3<double>::zero());
    for (const char* attribute : {"axisangle", "euler", "xyaxes", "zaxis"}) {
      if (!body.has(attribute)) continue;
      body.note_serious(LoadAction::kIgnored, std::string("PyBullet does not turn bodies by '") + attribute + "'");
      return {Mat3<double>::identity(), p};
    }
    return read_pose(body, scene_.settings_of(body));
  }

  void read_body(int parent, const MjcfPlaced& placed) {
    constexpr std::size_t kMostNested = 1000;
    if (++depth_ > kMostNested) placed.element.fail("bodies are nested more than 1000 deep");
    const std::size_t index = scene_.bodies.size();
    const std::string name = claim_name(scene_.body_names, placed.element, "body", index, scene_.reserved);
    const MjcfElement element = placed.element.named("body '" + name + "'");
    element.expect({"name", "childclass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "mocap", "gravcomp"},
                   kContents);
    const MjcfBody around = scene_.bodies[static_cast<std::size_t>(parent)];
    const MjcfSettings& settings = scene_.settings_of(element);
    // of the body around it or, global, the world
    const Transform<double> X_FB = element.source().is_bullet() ? bullets_pose(element) : read_pose(element, settings);
    const Transform<double> X_PB = placed_in(placed.X_BF, X_FB);
    Contents contents;
    collect(element, settings.is_global ? inverse(X_FB) : Transform<double>::identity(), contents);
    MjcfBody body{.name = name, .link = {}, .X_WB = around.X_WB * X_PB, .parent = parent, .source = element};
    body.has_joints = !contents.joints.empty();
    body.has_chain = contents.joints.size() > 1;
    body.first_moving = body.has_joints ? static_cast<int>(index) : around.first_moving;
    body.is_mocap = element.boolean_or("mocap", false);
    if (body.is_mocap && (parent != 0 || body.has_joints)) {
      element.fail("a mocap body belongs to <worldbody> and has no joints");
    }
    body.link = add_joints(scene_, body, around.link, X_PB, contents.joints);
    scene_.builder.link(body.link).gravity_compensation = element.number_or("gravcomp", 0);
    scene_.bodies.push_back(std::move(body));
    read_contents(index, contents);
    --depth_;
  }

  void read_contents(std::size_t index, const Contents& contents) {
    Inertial from_geoms;
    Mat3<double> axes = Mat3<double>::identity();  // of the only geom with mass
    int with_mass = 0;
    for (const MjcfPlaced& geom : contents.geoms) {
      if (index == 0 && geom.element.source().is_bullet()) {
        add_bullets_geom(geom);
        continue;
      }
      const MjcfGeomMass mass = add_geom(scene_, static_cast<int>(index), geom);
      const auto& [first, last] = scene_.settings_of(geom.element).inertia_groups;
      if (mass.group < first || mass.group > last || !(mass.inertial.mass > 0)) continue;
      const Inertial both = sum(from_geoms, mass.inertial);
      // Bullet puts the centre of mass where the last geom has its own.
      from_geoms = scene_.root.source().is_bullet() ? Inertial{both.mass, mass.inertial.com, both.inertia} : both;
      axes = mass.axes;
      ++with_mass;
    }
    if (index == 0 && !contents.inertials.empty())
      contents.inertials[0].element.fail("the world cannot have an <inertial>");
    Transform<double> X_NB = Transform<double>::identity();  // the frame of the file in that of the link
    if (index > 0) {
      give_mass(index, contents, from_geoms);
      if (is_aligned(contents)) X_NB = align(index, contents, with_mass == 1 ? &axes : nullptr);
    }
    for (const MjcfPlaced& site : contents.sites) add_site(index, {site.element, X_NB * site.X_BF});
    for (const MjcfPlaced& body : contents.bodies) read_body(static_cast<int>(index), body);
    name_bullets_joint(scene_, scene_.bodies[index]);
  }

  /// To Bullet each geom of the world is a body that stands there.
  void add_bullets_geom(const MjcfPlaced& geom) {
    ++scene_.bullet_counts.bodies;
    const std::string name = geom.element.text_or("name", "anonymous");
    const Transform<double> X_WB = Transform<double>::identity();
    scene_.bodies.push_back(
        {.name = name, .link = add_bullets_base(scene_, name, X_WB, false), .X_WB = X_WB, .parent = 0});
    add_geom(scene_, static_cast<int>(scene_.bodies.size()) - 1, geom);
  }

  /// Whether the body's frame is to become its frame of inertia.
  [[nodiscard]] bool is_aligned(const Contents& contents) const {
    if (scene_.root.source().is_bullet()) return false;
    if (contents.joints.size() != 1 || !contents.bodies.empty()) return false;
    if (scene_.builder.joints()[scene_.joints.back().id.index()].type != JointType::kFloating) return false;
    const MjcfElement& joint = contents.joints[0].element;
    const bool by_default = scene_.settings_of(joint).align_free;
    const std::string word = joint.word_or("align", {"true", "false", "auto"}, "auto");
    return word == "auto" ? by_default : word == "true";
  }

  /// Moves the frame of a free body, the last one read, to its centre of mass and principal axes: those of <inertial>
  /// or of its only geom, if they say. Returns the old frame in the new one.
  Transform<double> align(std::size_t index, const Contents& contents, const Mat3<double>* axes_of_geom) {
    MjcfBody& body = scene_.bodies[index];
    Inertial& inertial = scene_.builder.link(body.link).inertial;
    const bool is_given = !contents.inertials.empty() &&
                          scene_.settings_of(*body.source).inertia_from_geoms != MjcfSettings::FromGeoms::kAlways;
    Mat3<double> R = principal_axes(inertial.inertia).R;
    if (is_given && !contents.inertials[0].element.has("fullinertia")) {
      const auto& [element, X_BF] = contents.inertials[0];
      R = X_BF.R * read_rotation(element, scene_.settings_of(element));
    } else if (!is_given && axes_of_geom != nullptr) {
      R = *axes_of_geom;
    }
    const Transform<double> X_BN{R, inertial.com}, X_NB = inverse(X_BN);
    inertial = manyhands::placed(X_NB, inertial);
    for (const MjcfGeom& geom : scene_.geoms) {
      if (geom.body != static_cast<int>(index) || !geom.id) continue;
      Geom& shown = scene_.builder.geom(*geom.id);
      shown.X_LG = placed_in(X_NB, shown.X_LG);
    }
    body.X_WB = placed_in(body.X_WB, X_BN);
    MjcfJoint& free = scene_.joints.back();
    free.anchor_W = body.X_WB.p;
    const Quat<double> r = to_quat(body.X_WB.R);
    Joint& joint = scene_.builder.joint(free.id);
    joint.initial = joint.spring_reference = {body.X_WB.p.x, body.X_WB.p.y, body.X_WB.p.z, r.x, r.y, r.z, r.w};
    return X_NB;
  }

  void give_mass(std::size_t index, const Contents& contents, const Inertial& from_geoms) {
    using enum MjcfSettings::FromGeoms;
    const MjcfBody& body = scene_.bodies[index];
    const MjcfSettings& settings = scene_.settings_of(*body.source);
    const bool is_bullet = body.source->source().is_bullet();
    const bool is_given = !contents.inertials.empty() && (is_bullet || settings.inertia_from_geoms != kAlways);
    Inertial inertial = settings.inertia_from_geoms == kNever ? Inertial{} : from_geoms;
    if (is_given) {
      const auto& [element, X_BF] = contents.inertials[0];
      inertial = manyhands::placed(X_BF, read_inertial(element.named(body.source->what())));
    }
    for (std::size_t i = 1; i < contents.inertials.size(); ++i) {
      contents.inertials[i].element.fail("a second <inertial>; expected one");
    }
    // What MuJoCo bounds but has no place of its own lies where the body's 'pos' says, in the body's own frame.
    if (!is_given && !(inertial.mass > 0) && settings.bound_mass > 0) {
      inertial.com = body.source->vec3_or("pos", Vec3<double>::zero());
    }
    inertial.mass = std::max(inertial.mass, settings.bound_mass);
    if (settings.bound_inertia > 0) bound_principal_moments(inertial.inertia, settings.bound_inertia);
    const MjcfElement& source = is_given ? contents.inertials[0].element : *body.source;
    if (settings.balance_inertia && !repairs_to_itself(inertial)) {
      const double mean = (inertial.inertia.xx + inertial.inertia.yy + inertial.inertia.zz) / 3;
      inertial.inertia = {mean, mean, mean, 0, 0, 0};
    }
    if (const auto repair = repair_inertial(inertial)) source.note(LoadAction::kRepaired, *repair);
    checked(source, [&] { check_inertial(body.name, inertial); });
    scene_.builder.link(body.link).inertial = inertial;
  }

  static bool repairs_to_itself(Inertial inertial) { return !repair_inertial(inertial).has_value(); }

  Inertial read_inertial(const MjcfElement& e) const {
    e.expect({"pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "mass", "diaginertia", "fullinertia"});
    if (!e.has("mass")) e.fail("<inertial> has no 'mass'; expected one such as mass=\"1\"");
    SymMat3<double> I = SymMat3<double>::zero();
    if (e.has("fullinertia")) {
      if (e.has("diaginertia")) e.fail("<inertial> has both 'diaginertia' and 'fullinertia'; expected one");
      const std::vector<double> v = e.numbers("fullinertia", 6, 6);
      I = {v[0], v[1], v[2], v[3], v[4], v[5]};
    } else if (e.has("diaginertia")) {
      const Vec3<double> d = e.vec3_or("diaginertia", Vec3<double>::zero());
      I = {d.x, d.y, d.z, 0, 0, 0};
    }
    const Transform<double> X_BC = read_pose(e, scene_.settings_of(e));
    return {e.positive_or("mass", 0), X_BC.p, rotated(X_BC.R, I)};
  }

  /// Where `half_length` is not 0, along z, as 'fromto' says.
  [[nodiscard]] static Shape shape_of_site(const MjcfElement& site, double half_length) {
    const std::string type = site.word_or("type", {"sphere", "capsule", "ellipsoid", "cylinder", "box"}, "sphere");
    std::vector<double> size = site.has("size") ? site.numbers("size", 1, 3) : std::vector<double>{0.005};
    size.resize(3, size.size() == 1 && !site.has("size") ? 0.005 : 0.0);
    const bool is_round = type == "capsule" || type == "cylinder";
    if (half_length > 0) (is_round ? size[1] : size[2]) = half_length;
    const ShapeType shape = type == "capsule"    ? ShapeType::kCapsule
                            : type == "cylinder" ? ShapeType::kCylinder
                            : type == "box"      ? ShapeType::kBox
                                                 : ShapeType::kSphere;
    const bool is_ball = type != "ellipsoid" || (size[0] == size[1] && size[1] == size[2]);
    return {.type = is_ball ? shape : ShapeType::kConvex, .size = {size[0], size[1], size[2]}};
  }

  void add_site(std::size_t index, const MjcfPlaced& placed) {
    const std::string given = placed.element.text_or("name", "");
    const MjcfElement site = placed.element.named("site '" + given + "'").with_defaults(scene_.classes, "site");
    site.expect({"name", "class", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "fromto", "type", "size",
                 "group", "rgba", "material", "user"});
    Transform<double> X_LS = placed_in(placed.X_BF, read_pose(site, scene_.settings_of(site)));
    double half_length = 0;
    if (site.has("fromto")) {
      const std::vector<double> v = site.numbers("fromto", 6, 6);
      const Vec3<double> from{v[0], v[1], v[2]}, to{v[3], v[4], v[5]};
      if (!(norm(from - to) > 1e-10)) site.fail("the ends of 'fromto' are one point");
      X_LS = placed_in(placed.X_BF, {rotation_from_z(from - to), 0.5 * (from + to)});
      half_length = 0.5 * norm(from - to);
    }
    const Shape shape = shape_of_site(site, half_length);
    const MjcfBody& body = scene_.bodies[index];
    const std::size_t number = scene_.num_sites++;
    std::string name = given.empty() ? "site_" + std::to_string(number) : given;
    const bool taken = !scene_.sites.emplace(name, MjcfSite{body.link, X_LS, shape}).second;
    if (taken) site.fail("the name is taken by another site; expected another name");
    // Links and sites share the names of frames here; MuJoCo keeps them apart.
    const std::string wanted = name;
    while (is_link_name(name) || (name != given && scene_.reserved.contains(name))) name += "_site";
    if (name != wanted)
      site.note(LoadAction::kRepaired, "the frame is called " + in_quotes(name) + ", as a body has its name");
    scene_.builder.add_frame(name, body.link, X_LS);
  }

  [[nodiscard]] bool is_link_name(const std::string& name) const {
    return name == "world" || scene_.declared_bodies.contains(name) ||
           std::ranges::any_of(scene_.builder.links(), [&](const Link& link) { return link.name == name; });
  }

  MjcfScene& scene_;
  std::size_t depth_ = 0;
  int num_replicas_ = 0;
};

/// Settles what <compiler> asks of all masses together.
void scale_total_mass(MjcfScene& scene) {
  if (scene.settings.total_mass <= 0) return;
  double total = 0;
  for (const Link& link : scene.builder.links()) total += link.inertial.mass;
  if (!(total > 0)) return;
  for (std::size_t i = 0; i < scene.builder.links().size(); ++i) {
    Link& link = scene.builder.link(LinkId(i));
    link.inertial = scaled(link.inertial, scene.settings.total_mass / total);
  }
}

/// Stiffness and damping of joints that ask for a time constant and a ratio of damping (mjCModel::AutoSpringDamper).
void settle_springs(MjcfScene& scene) {
  const std::vector<double> inertias = yielding_inertias(scene);
  for (std::size_t i = 0; i < inertias.size(); ++i) {
    const double inertia = scene.joints[i].inertia = inertias[i];
    const auto [time, ratio] = scene.joints[i].spring_damper;
    if (!(time > 0 && ratio > 0)) continue;
    Joint& joint = scene.builder.joint(scene.joints[i].id);
    joint.stiffness = inertia / std::max(time * time * ratio * ratio, 1e-15);
    joint.damping = 2 * inertia / std::max(time, 1e-15);
  }
}

}  // namespace

void read_world(MjcfScene& scene) {
  WorldReader(scene).read();
  scale_total_mass(scene);
  settle_springs(scene);
}

}  // namespace manyhands::io
