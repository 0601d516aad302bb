#include "manyhands/model/io/mjcf/mjcf_settings.h"

#include <algorithm>
#include <numbers>

#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/unit.h"

namespace manyhands::io {

double MjcfSettings::radians(double angle) const { return degrees ? angle * std::numbers::pi / 180 : angle; }

namespace {

void read_compiler(const MjcfElement& e, MjcfSettings& settings) {
  e.expect({"angle", "coordinate", "eulerseq", "autolimits", "meshdir", "texturedir", "assetdir", "strippath",
            "inertiafromgeom", "inertiagrouprange", "balanceinertia", "boundmass", "boundinertia", "settotalmass",
            "usethread", "fusestatic", "discardvisual", "alignfree", "fitaabb"});
  settings.degrees = e.word_or("angle", {"degree", "radian"}, settings.degrees ? "degree" : "radian") == "degree";
  settings.is_global = e.word_or("coordinate", {"local", "global"}, "local") == "global";
  if (settings.is_global && !e.source().is_bullet()) {
    e.fail("coordinate=\"global\" is not read, nor by MuJoCo since 2.3.4; expected local coordinates");
  }
  settings.euler_sequence = e.text_or("eulerseq", settings.euler_sequence);
  const bool three = settings.euler_sequence.size() == 3;
  if (!three || settings.euler_sequence.find_first_not_of("xyzXYZ") != std::string::npos) {
    e.fail("attribute 'eulerseq' of <compiler> holds " + in_quotes(settings.euler_sequence) +
           "; expected three of x, y, z, X, Y and Z");
  }
  settings.autolimits = e.boolean_or("autolimits", settings.autolimits);
  settings.mesh_folder = e.text_or("meshdir", e.text_or("assetdir", settings.mesh_folder));
  settings.texture_folder = e.text_or("texturedir", e.text_or("assetdir", settings.texture_folder));
  settings.strip_path = e.boolean_or("strippath", settings.strip_path);
  if (e.has("inertiafromgeom")) {
    const std::string word = e.word_or("inertiafromgeom", {"false", "true", "auto"}, "auto");
    using enum MjcfSettings::FromGeoms;
    settings.inertia_from_geoms = word == "true" ? kAlways : word == "false" ? kNever : kWhereMissing;
  }
  if (e.has("inertiagrouprange")) {
    const std::vector<double> range = e.numbers("inertiagrouprange", 2, 2);
    settings.inertia_groups = {static_cast<int>(range[0]), static_cast<int>(range[1])};
  }
  settings.balance_inertia = e.boolean_or("balanceinertia", settings.balance_inertia);
  settings.bound_mass = e.positive_or("boundmass", settings.bound_mass);
  settings.bound_inertia = e.positive_or("boundinertia", settings.bound_inertia);
  settings.total_mass = e.number_or("settotalmass", settings.total_mass);
  if (e.source().is_bullet()) settings.total_mass = -1;
  if (e.boolean_or("fusestatic", false)) {
    e.note(LoadAction::kIgnored, "fusestatic: bodies without joints keep their names; the motion is the same");
  }
  if (e.boolean_or("discardvisual", false)) {
    e.note(LoadAction::kIgnored, "discardvisual: geoms that touch nothing are kept as visuals");
  }
  settings.align_free = e.boolean_or("alignfree", settings.align_free);
  settings.fit_to_box = e.boolean_or("fitaabb", settings.fit_to_box);
}

/// Turns off what the flag disables, and on what an earlier one disabled.
void read_flag(const MjcfElement& e, MjcfFlags& flags) {
  const std::array<std::pair<const char*, std::vector<bool*>>, 12> known{
      {{"contact", {&flags.contact}},
       {"equality", {&flags.equality}},
       {"frictionloss", {&flags.friction_loss}},
       {"limit", {&flags.limit}},
       {"constraint", {&flags.contact, &flags.equality, &flags.friction_loss, &flags.limit}},
       {"gravity", {&flags.gravity}},
       {"spring", {&flags.spring}},
       {"damper", {&flags.damper}},
       {"passive", {&flags.spring, &flags.damper}},  // of older files
       {"actuation", {&flags.actuation}},
       {"clampctrl", {&flags.clamp_ctrl}},
       {"filterparent", {&flags.filter_parent}}}};
  e.expect({"contact", "equality", "frictionloss", "limit", "constraint", "gravity", "spring", "damper", "passive",
            "actuation", "clampctrl", "filterparent", "override"});
  for (const auto& [name, targets] : known) {
    if (!e.has(name)) continue;
    const bool is_on = e.word_or(name, {"enable", "disable"}, "enable") == "enable";
    const bool is_sum = targets.size() > 1;
    for (bool* const target : targets) *target = is_sum ? *target && is_on : is_on;
  }
  if (e.word_or("override", {"enable", "disable"}, "disable") == "enable") {
    e.note_serious(LoadAction::kIgnored, "'override' and what it asks of all contacts are not used");
  }
}

void read_option(const MjcfElement& e, MjcfSettings& settings) {
  e.expect({"timestep", "gravity", "density", "viscosity", "wind"}, {"flag"});
  settings.time_step = e.number_or("timestep", settings.time_step);
  if (!(settings.time_step > 0)) e.fail("the time step must be above 0");
  settings.gravity = e.vec3_or("gravity", settings.gravity);
  settings.medium.density = e.number_or("density", settings.medium.density);
  settings.medium.viscosity = e.number_or("viscosity", settings.medium.viscosity);
  settings.medium.wind = e.vec3_or("wind", settings.medium.wind);
  if (settings.medium.density < 0 || settings.medium.viscosity < 0)
    e.fail("a density or viscosity below 0; expected 0 or more");
  for (const MjcfElement& child : e.children("flag")) read_flag(child.named("option flag"), settings.flags);
}

constexpr std::string_view kActuators[] = {"general",  "motor",  "position", "velocity", "intvelocity", "damper",
                                           "cylinder", "muscle", "adhesion", "plugin",   "dcmotor"};

void read_class(const MjcfElement& element, const std::string& name, const MjcfClass& above, MjcfClasses& classes) {
  MjcfClass& own = classes.by_name[name];
  for (const auto& [kind, values] : above.values) own.values[kind].insert(values.begin(), values.end());
  const std::vector<MjcfElement> children = element.children();
  for (const MjcfElement& child : children) {
    if (child.tag() == "default") continue;
    const bool is_actuator = std::ranges::find(kActuators, child.tag()) != std::ranges::end(kActuators);
    auto& values = own.values[is_actuator ? "actuator" : std::string(child.tag())];
    for (const auto& [attribute, value] : child.own_attributes()) values.insert_or_assign(attribute, value);
  }
  // A copy: deeper classes move the map's entries not, but may be this one again.
  const MjcfClass whole = own;
  for (const MjcfElement& child : children) {
    if (child.tag() != "default") continue;
    const std::string inner = child.text("class");
    if (inner == name) child.fail("the default class " + in_quotes(inner) + " lies in itself; expected another name");
    read_class(child, inner, whole, classes);
  }
}

}  // namespace

MjcfSettings read_settings(const MjcfElement& root) {
  MjcfSettings settings;
  for (const MjcfElement& e : root.children("compiler")) read_compiler(e.named("compiler"), settings);
  if (root.model() > 0) return settings;
  for (const MjcfElement& e : root.children("option")) read_option(e.named("option"), settings);
  return settings;
}

void read_classes(const MjcfElement& root, MjcfClasses& classes) {
  std::string main;
  for (const MjcfElement& e : root.children("default")) {
    const MjcfElement element = e.named("default");
    const std::string name =
        element.text_or("class", main.empty() ? root.source().models()[root.model()].main_class : main);
    if (main.empty()) root.source().set_main_class(root.model(), main = name);
    const MjcfClass above = name == main ? MjcfClass{} : classes.by_name.at(main);
    read_class(element, name, above, classes);
  }
}

Quat<double> quat_from_wxyz(const MjcfElement& element, const double* wxyz) {
  const Quat<double> q{wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
  const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (!(length2 > 1e-20)) element.fail("a quaternion of length 0; expected one such as \"1 0 0 0\"");
  return at_unit_length(q);
}

Mat3<double> rotation_from_z(const Vec3<double>& direction) {
  const Vec3<double> d = (1 / norm(direction)) * direction;
  const Vec3<double> across = cross({0, 0, 1}, d);
  const double sine = norm(across);
  const Vec3<double> axis = sine < 1e-10 ? Vec3<double>{1, 0, 0} : (1 / sine) * across;
  return to_matrix(quat_from_rotation_vector(atan2(sine, d.z) * axis));
}

Mat3<double> rotation_from_euler(const Vec3<double>& angles, const MjcfSettings& settings) {
  const std::array<double, 3> in_turn{angles.x, angles.y, angles.z};
  Mat3<double> R = Mat3<double>::identity();
  for (std::size_t i = 0; i < 3; ++i) {
    const char letter = settings.euler_sequence[i];
    const char axis = static_cast<char>(letter | 0x20);
    const double angle = settings.radians(in_turn[i]);
    const Vec3<double> turn{axis == 'x' ? angle : 0, axis == 'y' ? angle : 0, axis == 'z' ? angle : 0};
    const Mat3<double> step = to_matrix(quat_from_rotation_vector(turn));
    R = axis == letter ? R * step : step * R;  // lower case: about moving axes
  }
  return R;
}

namespace {

constexpr std::array<const char*, 5> kRotations{"quat", "axisangle", "euler", "xyaxes", "zaxis"};

Mat3<double> read_xyaxes(const MjcfElement& element) {
  const std::vector<double> v = element.numbers("xyaxes", 6, 6);
  Vec3<double> x{v[0], v[1], v[2]}, y{v[3], v[4], v[5]};
  if (!(norm(x) > 1e-10)) element.fail("the x axis of 'xyaxes' is 0");
  x = (1 / norm(x)) * x;
  y = y - dot(x, y) * x;
  if (!(norm(y) > 1e-10)) element.fail("the axes of 'xyaxes' are parallel, or y is 0");
  y = (1 / norm(y)) * y;
  return {x, y, cross(x, y)};
}

Mat3<double> read_rotation_as(const MjcfElement& element, std::string_view kind, const MjcfSettings& settings) {
  if (kind == "quat") return to_matrix(quat_from_wxyz(element, element.numbers("quat", 4, 4).data()));
  if (kind == "euler") return rotation_from_euler(element.vec3_or("euler", {}), settings);
  if (kind == "xyaxes") return read_xyaxes(element);
  if (kind == "zaxis") {
    const Vec3<double> z = element.vec3_or("zaxis", {0, 0, 1});
    if (!(norm(z) > 1e-10)) element.fail("the axis of 'zaxis' is 0");
    return rotation_from_z(z);
  }
  const std::vector<double> v = element.numbers("axisangle", 4, 4);
  const Vec3<double> axis{v[0], v[1], v[2]};
  if (!(norm(axis) > 1e-10)) element.fail("the axis of 'axisangle' is 0");
  return to_matrix(quat_from_rotation_vector((settings.radians(v[3]) / norm(axis)) * axis));
}

}  // namespace

namespace {

Mat3<double> of_a_quaternion(const Mat3<double>& R) { return to_matrix(normalized(to_quat(R))); }

bool is_identity(const Mat3<double>& R) { return R.x.x == 1 && R.y.y == 1 && R.z.z == 1; }

}  // namespace

bool has_rotation(const MjcfElement& element) {
  return std::ranges::any_of(kRotations, [&](const char* kind) { return element.has(kind); });
}

Mat3<double> read_rotation(const MjcfElement& element, const MjcfSettings& settings) {
  // What the element says itself goes before what its class says in another way.
  for (const bool own : {true, false}) {
    const char* chosen = nullptr;
    for (const char* const kind : kRotations) {
      if (!(own ? element.has_own(kind) : element.has(kind))) continue;
      if (chosen != nullptr) {
        element.fail(std::string("both '") + chosen + "' and '" + kind + "' say how it is turned; expected one");
      }
      chosen = kind;
    }
    if (chosen == nullptr) continue;
    const Mat3<double> R = read_rotation_as(element, chosen, settings);
    return std::string_view(chosen) == "quat" ? R : of_a_quaternion(R);
  }
  return Mat3<double>::identity();
}

Transform<double> placed_in(const Transform<double>& X_AF, const Transform<double>& X_FB) {
  const Transform<double> X_AB = X_AF * X_FB;
  return {is_identity(X_AF.R) ? X_FB.R : of_a_quaternion(X_AB.R), X_AB.p};
}

Transform<double> read_pose(const MjcfElement& element, const MjcfSettings& settings) {
  return {read_rotation(element, settings), element.vec3_or("pos", Vec3<double>::zero())};
}

}  // namespace manyhands::io
