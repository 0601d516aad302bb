#include "manyhands/model/model_archive.h"

#include "manyhands/base/bytes.h"
#include "manyhands/model/fingerprint.h"

namespace manyhands {

namespace {

template <class T, class Of>
concept Either = std::same_as<std::remove_const_t<T>, Of>;  // to be read, or to be written

}  // namespace

// Structured bindings name every field: a new one does not compile before it is listed.

template <class Archive, Either<Link> T>
void visit_fields(Archive& archive, T& link) {
  auto& [name, inertial, axes, scale, lifted, parent, joint, body, X_BL] = link;
  archive(name, inertial, axes, scale, lifted, parent, joint, body, X_BL);
}

template <class Archive, Either<Mimic> T>
void visit_fields(Archive& archive, T& mimic) {
  auto& [joint, multiplier, offset] = mimic;
  archive(joint, multiplier, offset);
}

template <class Archive, Either<Joint> T>
void visit_fields(Archive& archive, T& joint) {
  auto& [name, type, parent, child, X_PF, axis, limits, damping, friction, armature, stiffness, mimic, initial,
         reference, iq, iv] = joint;
  archive(name, type, parent, child, X_PF, axis, limits, damping, friction, armature, stiffness, mimic, initial,
          reference, iq, iv);
}

template <class Archive, Either<Mesh> T>
void visit_fields(Archive& archive, T& mesh) {
  auto& [source, scale, vertices, triangles] = mesh;
  archive(source, scale, vertices, triangles);
}

template <class Archive, Either<HeightField> T>
void visit_fields(Archive& archive, T& field) {
  auto& [columns, rows, dx, dy, height] = field;
  archive(columns, rows, dx, dy, height);
}

template <class Archive, Either<GeomTexture> T>
void visit_fields(Archive& archive, T& texture) {
  auto& [file, rgb, repeat] = texture;
  archive(file, rgb, repeat);
}

template <class Archive, Either<Geom> T>
void visit_fields(Archive& archive, T& geom) {
  auto& [name, role, link, X_LG, shape, rgba, texture, surface, filter, margin] = geom;
  archive(name, role, link, X_LG, shape, rgba, texture, surface, filter, margin);
}

template <class Archive, Either<Keyframe> T>
void visit_fields(Archive& archive, T& keyframe) {
  auto& [name, time, q, v, ctrl, act, mocap] = keyframe;
  archive(name, time, q, v, ctrl, act, mocap);
}

template <class Archive, Either<Frame> T>
void visit_fields(Archive& archive, T& frame) {
  auto& [name, body, X_BF, link, X_LF] = frame;
  archive(name, body, X_BF, link, X_LF);
}

template <class Archive, Either<TendonBranch> T>
void visit_fields(Archive& archive, T& branch) {
  auto& [divisor, points] = branch;
  archive(divisor, points);
}

template <class Archive, Either<Tendon> T>
void visit_fields(Archive& archive, T& tendon) {
  auto& [name, joints, branches, lower, upper, compliance, damping, friction, armature, stiffness, spring_lower,
         spring_upper] = tendon;
  archive(name, joints, branches, lower, upper, compliance, damping, friction, armature, stiffness, spring_lower,
          spring_upper);
}

template <class Archive, Either<EqualityConstraint> T>
void visit_fields(Archive& archive, T& equality) {
  auto& [name, type, link_a, link_b, X_LA, X_LB, joint_a, joint_b, tendon_a, tendon_b, polynomial, reference_a,
         reference_b, ratio, offset, max_force, compliance, torque_scale] = equality;
  archive(name, type, link_a, link_b, X_LA, X_LB, joint_a, joint_b, tendon_a, tendon_b, polynomial, reference_a,
          reference_b, ratio, offset, max_force, compliance, torque_scale);
}

template <class Archive, Either<Actuator> T>
void visit_fields(Archive& archive, T& actuator) {
  auto& [name, type, joint, tendon, site, gear, ctrl_scale, ctrl_offset, kp, kd, gain, bias, activation, iact, min_ctrl,
         max_ctrl, max_force, min_force] = actuator;
  archive(name, type, joint, tendon, site, gear, ctrl_scale, ctrl_offset, kp, kd, gain, bias, activation, iact,
          min_ctrl, max_ctrl, max_force, min_force);
}

template <class Archive, Either<Sensor> T>
void visit_fields(Archive& archive, T& sensor) {
  auto& [name, type, joint, tendon, actuator, link, X_LF, reference, X_LR, volume, cutoff] = sensor;
  archive(name, type, joint, tendon, actuator, link, X_LF, reference, X_LR, volume, cutoff);
}

class ModelArchive {
 public:
  template <class Archive, Either<Model> T>
  static void visit(Archive& archive, T& model) {
    auto& [name, nq, nv, na, links, joints, bodies, lifts, mocap_bodies, frames, geoms, meshes, height_fields,
           equalities, described_equalities, tendons, actuators, sensors, exclusions, contact_pairs, contact_rules,
           dof_parent, dof_joint, dof_q, dof_limits, dof_damping, dof_armature, dof_friction, dof_stiffness, keyframes,
           time_step, gravity, medium, link_names, joint_names, frame_names, geom_names, link_geoms, link_children,
           body_links] = model;
    archive(name, nq, nv, na, links, joints, bodies, lifts, mocap_bodies, frames, geoms, meshes, height_fields,
            equalities, described_equalities, tendons, actuators, sensors, exclusions, contact_pairs, contact_rules,
            dof_parent, dof_joint, dof_q, dof_limits, dof_damping, dof_armature, dof_friction, dof_stiffness, keyframes,
            time_step, gravity, medium, link_names, joint_names, frame_names, geom_names, link_geoms, link_children,
            body_links);
  }
};

std::vector<std::uint8_t> archived(const Model& model) {
  ByteWriter out;
  out(fingerprint(model));
  ModelArchive::visit(out, model);
  return out.finish();
}

Model unarchived(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  std::uint64_t expected = 0;
  Model model;
  in(expected);
  ModelArchive::visit(in, model);
  if (fingerprint(model) != expected) throw std::invalid_argument("the model's bytes are of another build");
  return model;
}

}  // namespace manyhands
