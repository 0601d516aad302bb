// A scene in the making: what is shared by the readers of the sections of an MJCF file.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "manyhands/model/io/mjcf/mjcf_assets.h"
#include "manyhands/model/io/mjcf/mjcf_settings.h"
#include "manyhands/model/model_builder.h"

namespace manyhands::io {

struct MjcfBody {
  std::string name;
  LinkId link;
  Transform<double> X_WB;  ///< as the file places it: at qpos0
  int parent = -1;         ///< index of the body around it; -1 for the world
  int first_moving = 0;    ///< the body whose joints move it: itself, or one around it; 0 for what is fixed
  bool has_joints = false;
  bool is_mocap = false;    ///< a user moves it
  bool has_chain = false;   ///< several joints, so that links without a name of their own lie between
  int bullet_number = 0;    ///< of its link, where Bullet's rules hold
  int bullet_carrier = -1;  ///< the number of the link that it is fixed to by them
  std::optional<MjcfElement> source{};
};

/// What Bullet numbers names by.
struct MjcfBulletCounts {
  int bodies = 0;  ///< so far
  int links = 0;   ///< of the body that is being read
  int fixed = 0;   ///< joints, of all bodies
};

struct MjcfJoint {
  std::string name;
  JointId id;
  double reference = 0;                   ///< qpos0, where it has one coordinate
  int body = 0;                           ///< index of the body that it moves
  Vec3<double> anchor_W{}, axis_W{};      ///< at qpos0
  std::array<double, 2> spring_damper{};  ///< time constant [s] and ratio of damping; 0 where they do not say
  double inertia = 0;                     ///< that it meets at qpos0 while other joints yield (see mjcf_inertia.h)
};

struct MjcfGeom {
  std::string name;
  std::optional<GeomId> id;  ///< none for what was left out
  MjcfElement source;
  int body = 0;  ///< index
  int contype = 1, conaffinity = 1, condim = 3, priority = 0;
  std::array<double, 3> friction{};  ///< sliding, spinning, rolling, whatever condim says
  std::optional<Compliance> compliance{};
  bool is_in_pair = false;
};

struct MjcfSite {
  LinkId link;
  Transform<double> X_LS;
  Shape shape{};  ///< within which it feels touch; an ellipsoid is kConvex without a mesh
};

struct MjcfTendon {
  std::string name;
  std::optional<TendonId> id{};  ///< none for what was left out
  double length = 0;             ///< at qpos0
};

/// Indices by name; a name comes once.
using MjcfNames = std::map<std::string, int, std::less<>>;

struct MjcfScene {
  MjcfScene(const MjcfElement& root_element, bool load_meshes);

  MjcfElement root;
  std::vector<MjcfElement> attached;       ///< the roots of attached models
  std::vector<MjcfSettings> all_settings;  ///< by model
  const MjcfSettings& settings;            ///< of the main one
  MjcfCompliance compliance = MjcfCompliance::kStated;
  MjcfClasses classes;
  MjcfAssets assets;
  ModelBuilder builder;
  std::vector<MjcfBody> bodies;  ///< MuJoCo's order and numbers; 0 is the world
  std::vector<MjcfJoint> joints;
  std::vector<MjcfGeom> geoms;
  std::map<std::string, MjcfSite, std::less<>> sites;
  std::vector<MjcfTendon> tendons;
  MjcfNames body_names, joint_names, geom_names, tendon_names;
  std::set<std::string, std::less<>> reserved;         ///< every name in the file: what is named here must differ
  std::set<std::string, std::less<>> declared_bodies;  ///< the names of bodies among them
  MjcfBulletCounts bullet_counts;
  std::size_t num_sites = 0, num_equalities = 0;
  std::map<std::array<double, 3>, MeshId> ellipsoids;          ///< hulls by half axes
  std::set<std::pair<LinkId, LinkId>> exclusions;              ///< of <contact>, the lesser id first
  std::map<std::pair<GeomId, GeomId>, SurfaceMaterial> pairs;  ///< of <contact>, the lesser id first
  std::vector<int> actuators;                                  ///< by their place in the file, the index here or -1
  std::vector<std::size_t> activations;  ///< by their place in the file: how many numbers they have in a key's act

  /// Those of the model that the element is written in.
  [[nodiscard]] const MjcfSettings& settings_of(const MjcfElement& e) const { return all_settings[e.model()]; }
  /// All sections of that name: those of the main model, then those of attached ones.
  [[nodiscard]] std::vector<MjcfElement> sections(std::string_view tag) const;
  /// What is in them that acts on parts which are there. As in MuJoCo, what refers to parts of an attached model that
  /// were left behind is dropped.
  [[nodiscard]] std::vector<MjcfElement> elements(const MjcfElement& section) const;
  /// The part that an attribute names; fails if there is none.
  [[nodiscard]] const MjcfBody& body(const MjcfElement& user, const char* attribute) const;
  [[nodiscard]] const MjcfJoint& joint(const MjcfElement& user, const char* attribute) const;
  [[nodiscard]] std::size_t geom(const MjcfElement& user, const char* attribute) const;
  [[nodiscard]] const MjcfSite& site(const MjcfElement& user, const char* attribute) const;
  [[nodiscard]] const MjcfTendon& tendon(const MjcfElement& user, const char* attribute) const;
};

/// The name of an element, or kind_index, which is lengthened until nothing in the file bears it; fails if it is taken.
[[nodiscard]] std::string claim_name(MjcfNames& names, const MjcfElement& element, const char* kind, std::size_t index,
                                     const std::set<std::string, std::less<>>& reserved);

/// What `make` gives; a part that the builder refuses becomes an error at the element.
template <class Make>
auto checked(const MjcfElement& element, Make make) {
  try {
    return make();
  } catch (const ModelError& error) {
    element.fail(error.what());
  }
}

// The readers, in the order in which they run.
void read_world(MjcfScene& scene);     ///< bodies, joints, geoms, sites
void read_contacts(MjcfScene& scene);  ///< filters, pairs, exclusions and rules
void read_tendons(MjcfScene& scene);
void read_equalities(MjcfScene& scene);
void read_actuators(MjcfScene& scene);
void read_sensors(MjcfScene& scene);
void read_keyframes(MjcfScene& scene);
void apply_flags(MjcfScene& scene);  ///< takes away what <flag> turns off

/// A geom's part in the mass of its body, about the body's frame.
struct MjcfGeomMass {
  Inertial inertial{};
  Mat3<double> axes = Mat3<double>::identity();  ///< of its own: those of the shape, principal ones of a mesh
  int group = 0;
};

/// An element in a body, and the frame in which its pose is given.
struct MjcfPlaced {
  MjcfElement element;
  Transform<double> X_BF;
};

/// The joint frame F in the parent at q = 0, which is short of the file's pose by the reference; the file places the
/// body at X_PB, and the joint at `anchor` in it.
[[nodiscard]] Transform<double> joint_frame(const Transform<double>& X_PB, const Vec3<double>& anchor,
                                            const Joint& joint, double reference);
/// Adds the joints between a parent link and a new body; returns the body's link.
[[nodiscard]] LinkId add_joints(MjcfScene& scene, MjcfBody& body, LinkId parent, const Transform<double>& X_PB,
                                const std::vector<MjcfPlaced>& joints);
/// The name by Bullet's rules of the joint that fixes the body, once what hangs on the body has been read.
void name_bullets_joint(MjcfScene& scene, const MjcfBody& body);
/// A link that begins at X_WB or stands there; '_' behind its name if another has it.
LinkId add_bullets_base(MjcfScene& scene, std::string name, const Transform<double>& X_WB, bool is_free);
/// A coefficient that recent files may give as a polynomial, of which the linear part counts.
[[nodiscard]] double linear_part(const MjcfElement& e, const char* attribute);
/// Whether it has the range: by `limited`, or on its own where autolimits is true.
[[nodiscard]] bool is_limited(const MjcfScene& scene, const MjcfElement& e, const char* range, const char* limited);
/// condim: 1, 3, 4 or 6.
[[nodiscard]] int read_condim(const MjcfElement& element, int fallback);
/// The frictions (sliding, spinning, rolling) of which contacts of so many dimensions know.
[[nodiscard]] SurfaceMaterial surface_of(const std::array<double, 3>& friction, int condim);
/// Adds a geom; its mass is that of its volume or what it is given.
MjcfGeomMass add_geom(MjcfScene& scene, int body, const MjcfPlaced& placed);

}  // namespace manyhands::io
