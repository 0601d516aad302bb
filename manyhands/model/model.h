// The immutable description that every world of a robot or scene shares.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "manyhands/model/actuator.h"
#include "manyhands/model/couplings.h"
#include "manyhands/model/sensor.h"

namespace manyhands {

/// What a kernel needs of one moving body. Links joined by fixed joints are one body; body 0 is the world.
///
/// The body frame B sits at its joint's origin and is turned so that the joint axis is +z: a kernel then rotates about
/// z and slides along z only. Where the described axis is already +z, B is the frame of the joint's child link.
struct Body {
  BodyId parent{};
  JointId joint{};  ///< the joint as described; invalid for the world
  JointType type = JointType::kFixed;
  Transform<double> X_PF = Transform<double>::identity();  ///< joint frame in the parent's body frame, axis on z
  int iq{}, nq{};
  int iv{}, nv{};
  RigidInertia<double> inertia = RigidInertia<double>::zero();  ///< of all its links about B's origin, in B's axes
};

/// A body part of whose weight gravity compensation carries.
struct Lift {
  BodyId body;
  double mass = 0;        ///< that is carried [kg]
  Vec3<double> moment{};  ///< its first moment about B's origin, in B's axes [kg m]
};

/// A named pose fixed on a body. Every link is a frame of the same name and index.
struct Frame {
  std::string name{};
  BodyId body{};
  Transform<double> X_BF = Transform<double>::identity();
  LinkId link{};  ///< on which it was described
  Transform<double> X_LF = Transform<double>::identity();
};

/// Thrown when a description cannot become a model; the message names the part and what to change.
class ModelError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// A robot or scene, made by `ModelBuilder::build`, never changed once it is shared by worlds and threads. Links and
/// joints keep the order in which they were added; bodies, and with them q and v, run depth first, so that a body's
/// parent precedes it.
class Model {
 public:
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] int nq() const { return nq_; }  ///< length of q
  [[nodiscard]] int nv() const { return nv_; }  ///< length of v, tau

  [[nodiscard]] std::span<const Link> links() const { return links_; }
  [[nodiscard]] std::span<const Joint> joints() const { return joints_; }
  [[nodiscard]] std::span<const Body> bodies() const { return bodies_; }
  [[nodiscard]] std::span<const Frame> frames() const { return frames_; }
  [[nodiscard]] std::span<const Geom> geoms() const { return geoms_; }
  [[nodiscard]] std::span<const Mesh> meshes() const { return meshes_; }
  [[nodiscard]] std::span<const HeightField> height_fields() const { return height_fields_; }
  [[nodiscard]] std::span<const EqualityConstraint> equalities() const {
    return equalities_;
  }  ///< mimic joints' included
  [[nodiscard]] std::span<const Tendon> tendons() const { return tendons_; }
  [[nodiscard]] std::span<const Actuator> actuators() const { return actuators_; }
  [[nodiscard]] int nu() const { return static_cast<int>(actuators_.size()); }  ///< length of ctrl
  [[nodiscard]] int na() const { return na_; }  ///< length of act: of the actuators that have an activation, in order
  [[nodiscard]] std::span<const Sensor> sensors() const { return sensors_; }
  [[nodiscard]] std::span<const ContactExclusion> exclusions() const { return exclusions_; }
  [[nodiscard]] std::span<const ContactPair> contact_pairs() const { return contact_pairs_; }
  [[nodiscard]] const ContactRules& contact_rules() const { return contact_rules_; }

  [[nodiscard]] const Link& link(LinkId id) const { return links_[id.index()]; }
  /// The link by which the mechanism that `id` belongs to stands in the world: alike for all links of one robot.
  [[nodiscard]] LinkId root_link(LinkId id) const;
  [[nodiscard]] const Joint& joint(JointId id) const { return joints_[id.index()]; }
  [[nodiscard]] const Body& body(BodyId id) const { return bodies_[id.index()]; }
  [[nodiscard]] const Frame& frame(FrameId id) const { return frames_[id.index()]; }
  [[nodiscard]] std::span<const Lift> lifts() const { return lifts_; }
  [[nodiscard]] std::span<const BodyId> mocap_bodies() const { return mocap_bodies_; }  ///< that a user moves
  /// Which of them carries the link of that name. Throws std::invalid_argument for other links.
  [[nodiscard]] std::size_t mocap_index(std::string_view link) const;
  [[nodiscard]] int num_bodies() const { return static_cast<int>(bodies_.size()); }

  /// Finds a part by name. Throws std::out_of_range that lists the names there are.
  [[nodiscard]] LinkId link_id(std::string_view name) const;
  [[nodiscard]] JointId joint_id(std::string_view name) const;
  [[nodiscard]] FrameId frame_id(std::string_view name) const;
  [[nodiscard]] TendonId tendon_id(std::string_view name) const;
  [[nodiscard]] const Sensor& sensor(std::string_view name) const;
  /// The same, but invalid if there is none.
  [[nodiscard]] LinkId find_link(std::string_view name) const;
  [[nodiscard]] GeomId find_geom(std::string_view name) const;  ///< the first of several that share the name
  /// The link of that name, and those called "name/...".
  [[nodiscard]] std::vector<LinkId> find_links(std::string_view name) const;

  // What belongs to a part, in order.
  [[nodiscard]] std::span<const GeomId> geoms_of(LinkId id) const { return link_geoms_[id.index()]; }
  [[nodiscard]] std::span<const LinkId> children_of(LinkId id) const { return link_children_[id.index()]; }
  [[nodiscard]] std::span<const LinkId> links_of(BodyId id) const { return body_links_[id.index()]; }

  /// For every velocity index, the next one towards the root that moves the same body, or -1: the sparsity of M.
  [[nodiscard]] std::span<const int> dof_parent() const { return dof_parent_; }
  [[nodiscard]] std::span<const int> dof_joint() const { return dof_joint_; }

  /// Limits, damping and so on by velocity index (nv); infinite or 0 for dofs of joints that have none.
  [[nodiscard]] std::span<const JointLimits> dof_limits() const { return dof_limits_; }
  [[nodiscard]] std::span<const double> dof_damping() const { return dof_damping_; }
  [[nodiscard]] std::span<const double> dof_armature() const { return dof_armature_; }
  [[nodiscard]] std::span<const double> dof_friction() const { return dof_friction_; }
  [[nodiscard]] std::span<const double> dof_stiffness() const { return dof_stiffness_; }
  /// The index in q that a velocity index integrates, for dofs with a single coordinate; else -1.
  [[nodiscard]] std::span<const int> dof_q() const { return dof_q_; }

  [[nodiscard]] Vec3<double> gravity() const { return gravity_; }   ///< [m/s^2], in the world frame
  [[nodiscard]] const Medium& medium() const { return medium_; }    ///< that links move through
  [[nodiscard]] std::vector<double> neutral_configuration() const;  ///< q with joints at 0, quaternions at identity
  [[nodiscard]] std::vector<double> initial_configuration() const;  ///< the same but for joints that start elsewhere
  [[nodiscard]] std::vector<double> initial_mocap() const;  ///< poses of the mocap bodies: x y z, quaternion xyzw each
  [[nodiscard]] std::vector<double> spring_reference() const;  ///< q at which the joints' springs are at rest
  [[nodiscard]] std::span<const Keyframe> keyframes() const { return keyframes_; }
  [[nodiscard]] const Keyframe& keyframe(std::string_view name) const;  ///< as `link_id`
  [[nodiscard]] std::optional<double> time_step() const {
    return time_step_;
  }  ///< [s], if the description asks for one

 private:
  friend class ModelBuilder;
  friend class ModelArchive;
  friend class ModelEdit;

  using NameIndex = std::map<std::string, int, std::less<>>;

  void index_parts();

  std::string name_;
  int nq_ = 0, nv_ = 0, na_ = 0;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::vector<Body> bodies_;
  std::vector<Lift> lifts_;
  std::vector<BodyId> mocap_bodies_;
  std::vector<Frame> frames_;
  std::vector<Geom> geoms_;
  std::vector<Mesh> meshes_;
  std::vector<HeightField> height_fields_;
  std::vector<EqualityConstraint> equalities_;
  int described_equalities_ = 0;  // those that follow are of mimic joints
  std::vector<Tendon> tendons_;
  std::vector<Actuator> actuators_;
  std::vector<Sensor> sensors_;
  std::vector<ContactExclusion> exclusions_;
  std::vector<ContactPair> contact_pairs_;
  ContactRules contact_rules_;
  std::vector<int> dof_parent_, dof_joint_, dof_q_;
  std::vector<JointLimits> dof_limits_;
  std::vector<double> dof_damping_, dof_armature_, dof_friction_, dof_stiffness_;
  std::vector<Keyframe> keyframes_;
  std::optional<double> time_step_;
  Vec3<double> gravity_{0, 0, -9.81};
  Medium medium_;
  NameIndex link_names_, joint_names_, frame_names_, geom_names_;  // frames: without the links' own
  std::vector<std::vector<GeomId>> link_geoms_;
  std::vector<std::vector<LinkId>> link_children_, body_links_;
};

}  // namespace manyhands
