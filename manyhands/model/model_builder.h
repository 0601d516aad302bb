// The only way to make a Model: loaders and user code add parts, `build` checks and compiles them.
#pragma once

#include "manyhands/model/load_report.h"
#include "manyhands/model/model.h"

namespace manyhands {

/// Collects links, joints, geoms and meshes. A link without a joint to a parent is a root and is welded to the world;
/// for a free body, join it by a floating joint to `world()`.
///
///     ModelBuilder builder("pendulum");
///     LinkId rod = builder.add_link("rod", {.mass = 1, .com = {0, 0, -0.5}});
///     builder.add_joint({.name = "hinge", .type = JointType::kContinuous, .parent = builder.world(), .child = rod,
///                        .axis = {0, 1, 0}});
///     Model model = builder.build();
class ModelBuilder {
 public:
  explicit ModelBuilder(std::string name = "model");

  /// The world as a link: the parent of whatever is fixed to or floats in it. Its name is "world".
  [[nodiscard]] LinkId world() const { return LinkId(0); }

  /// Adds a link. Throws ModelError if the name is taken or empty, or the inertial is not physical.
  LinkId add_link(std::string name, const Inertial& inertial = {});
  /// Adds a joint; parent and child must be added before. Throws ModelError on a taken name, a second parent, a zero
  /// axis, limits out of order, or an initial configuration of the wrong size.
  JointId add_joint(Joint joint);
  /// Where a joint starts, in q; empty: neutral. Throws ModelError on a wrong length or what is not finite.
  void set_initial(JointId joint, std::vector<double> q);
  /// Puts a link that will have no joint to a parent at X_WL in the world.
  void place_root(LinkId link, const Transform<double>& X_WL) { links_[link.index()].X_BL = X_WL; }
  /// Throws ModelError on a size that is not above 0, numbers that are not finite, a negative friction, or a mesh or
  /// height field that was not added before.
  GeomId add_geom(Geom geom);
  /// Throws ModelError on vertices that are not finite and triangles of vertices that do not exist.
  MeshId add_mesh(Mesh mesh);
  /// Throws ModelError unless the grid has 2 x 2 finite heights or more.
  HeightFieldId add_height_field(HeightField field);
  /// Throws ModelError unless it is named, and its joints of one degree of freedom, or its links, were added before.
  TendonId add_tendon(Tendon tendon);
  /// Throws ModelError unless the links, the joints of one degree of freedom, or the tendons were added before.
  EqualityId add_equality(EqualityConstraint equality);
  /// Throws ModelError unless the tendon, the joint of one degree of freedom, or the site's link was added before.
  ActuatorId add_actuator(Actuator actuator);
  /// Throws ModelError unless it is named, and what it measures was added before.
  void add_sensor(Sensor sensor);
  void exclude_contact(LinkId a, LinkId b);
  void add_contact_pair(const ContactPair& pair);
  void set_contact_rules(const ContactRules& rules) { contact_rules_ = rules; }
  /// The link that a frame lies on, which may be its own, and its pose there. Throws ModelError if there is none.
  [[nodiscard]] std::pair<LinkId, Transform<double>> frame(std::string_view name) const;
  /// Adds a named frame on a link, besides the links' own.
  void add_frame(std::string name, LinkId link, const Transform<double>& X_LF);
  void set_gravity(const Vec3<double>& gravity) { gravity_ = gravity; }
  /// Throws ModelError unless density and viscosity are 0 or more, and all is finite.
  void set_medium(const Medium& medium);
  void set_time_step(double time_step) { time_step_ = time_step; }  ///< [s], for worlds that are not told another
  /// Its sizes are checked by `build`; an empty q, v, ctrl or act becomes the initial one, or 0.
  void add_keyframe(Keyframe keyframe) { keyframes_.push_back(std::move(keyframe)); }

  [[nodiscard]] LoadReport& report() { return report_; }
  [[nodiscard]] const std::vector<Link>& links() const { return links_; }
  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }
  [[nodiscard]] Link& link(LinkId id) { return links_[id.index()]; }
  [[nodiscard]] Joint& joint(JointId id) { return joints_[id.index()]; }
  [[nodiscard]] const std::vector<Tendon>& tendons() const { return tendons_; }
  [[nodiscard]] Tendon& tendon(TendonId id) { return tendons_[id.index()]; }
  [[nodiscard]] const std::vector<Actuator>& actuators() const { return actuators_; }
  [[nodiscard]] Actuator& actuator(ActuatorId id) { return actuators_[id.index()]; }
  [[nodiscard]] const std::vector<Geom>& geoms() const { return geoms_; }
  [[nodiscard]] Geom& geom(GeomId id) { return geoms_[id.index()]; }

  /// Joints whose motion, at the neutral configuration, meets neither inertia nor armature: their acceleration would
  /// be infinite. A loader repairs these; `build` refuses them.
  [[nodiscard]] std::vector<JointId> joints_without_inertia() const;

  /// Checks the whole and compiles it. Throws ModelError on a cycle, an unknown mimic driver, or a joint without
  /// inertia.
  [[nodiscard]] Model build() const;

 private:
  struct NamedFrame {
    std::string name;
    LinkId link;
    Transform<double> X_LF;
  };

  [[nodiscard]] std::vector<LinkId> depth_first() const;
  [[nodiscard]] Model compile() const;
  void add_keyframes(Model& model) const;
  void require_link(const std::string& what, LinkId link) const;
  void require_single_dof(const std::string& what, JointId joint) const;
  void require_tendon(const std::string& what, TendonId tendon) const;
  void require_transmission(const std::string& what, const Actuator& actuator) const;
  void add_mimic_equalities(Model& model) const;
  static void compile_link(Model& model, LinkId id);
  static void compile_lift(Model& model, const Link& link);
  static void compile_dofs(Model& model);
  static void compile_activations(Model& model);

  std::string name_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::vector<Geom> geoms_;
  std::vector<Mesh> meshes_;
  std::vector<HeightField> height_fields_;
  std::vector<EqualityConstraint> equalities_;
  std::vector<Tendon> tendons_;
  std::vector<Actuator> actuators_;
  std::vector<Sensor> sensors_;
  std::vector<ContactExclusion> exclusions_;
  std::vector<ContactPair> contact_pairs_;
  ContactRules contact_rules_;
  std::vector<NamedFrame> frames_;
  Model::NameIndex link_names_, joint_names_, frame_names_;
  std::vector<Keyframe> keyframes_;
  std::optional<double> time_step_;
  Vec3<double> gravity_{0, 0, -9.81};
  Medium medium_;
  LoadReport report_;
};

}  // namespace manyhands
