#include "manyhands/model/compose.h"

#include <algorithm>
#include <map>

#include "manyhands/math/quaternion.h"

namespace manyhands {

namespace {

std::vector<int> chained(const std::vector<int>& first, const std::vector<int>& next) {
  std::vector<int> result;
  result.reserve(first.size());
  for (const int i : first) result.push_back(i < 0 ? -1 : next[static_cast<std::size_t>(i)]);
  return result;
}

/// One call of `append`.
class Appender {
 public:
  Appender(ModelBuilder& builder, const Model& model, const AppendOptions& options)
      : builder_(builder), model_(model), options_(options) {
    map_.links.assign(model.links().size(), -1);
    map_.joints.assign(model.joints().size(), -1);
    map_.geoms.assign(model.geoms().size(), -1);
    map_.tendons.assign(model.tendons().size(), -1);
    map_.actuators.assign(model.actuators().size(), -1);
    meshes_.resize(model.meshes().size());
    fields_.resize(model.height_fields().size());
  }

  PartMap run() {
    add_links();
    add_joints();
    add_geoms();
    add_tendons();
    add_equalities();
    add_actuators();
    add_sensors();
    add_contact_exceptions();
    add_frames();
    return std::move(map_);
  }

 private:
  [[nodiscard]] std::string named(const std::string& name) const {
    return name.empty() ? name : options_.prefix + name;
  }
  [[nodiscard]] LinkId link(LinkId id) const { return LinkId(map_.links[id.index()]); }
  [[nodiscard]] bool has(LinkId id) const { return map_.links[id.index()] >= 0; }
  [[nodiscard]] const Transform<double>& moved() const { return options_.X_WM; }

  /// Whether the link or one that it hangs on is left out.
  [[nodiscard]] bool is_left_out(LinkId id) const {
    if (options_.left_out.empty()) return false;
    for (; id.value() > 0; id = model_.link(id).parent) {
      if (options_.left_out[id.index()] != 0) return true;
    }
    return false;
  }

  void add_links() {
    map_.links[0] = options_.onto.value();
    for (std::size_t i = 1; i < model_.links().size(); ++i) {
      if (is_left_out(LinkId(i))) continue;
      const Link& from = model_.links()[i];
      const LinkId id = builder_.add_link(named(from.name), from.inertial);
      map_.links[i] = id.value();
      Link& to = builder_.link(id);
      to.inertial_axes = from.inertial_axes;
      to.inertia_scale = from.inertia_scale;
      to.gravity_compensation = from.gravity_compensation;
      if (!from.joint.is_valid()) place_base(id, moved() * from.X_BL);
    }
  }

  void place_base(LinkId base, const Transform<double>& X_PB) {
    if (options_.onto == builder_.world()) {
      builder_.place_root(base, X_PB);
      return;
    }
    const std::string name = builder_.link(base).name + "_mount";
    builder_.add_joint({.name = name, .type = JointType::kFixed, .parent = options_.onto, .child = base, .X_PF = X_PB});
  }

  void add_joints() {
    for (std::size_t i = 0; i < model_.joints().size(); ++i) {
      Joint joint = model_.joints()[i];
      if (!has(joint.child)) continue;
      if (joint.parent.value() == 0) move_base(joint);
      joint.name = named(joint.name);
      joint.parent = link(joint.parent);
      joint.child = link(joint.child);
      joint.iq = joint.iv = -1;
      if (joint.mimic) {
        const JointId driver = model_.joint_id(joint.mimic->joint);
        if (has(model_.joint(driver).child)) {
          joint.mimic->joint = named(joint.mimic->joint);
        } else {
          joint.mimic.reset();
        }
      }
      map_.joints[i] = builder_.add_joint(std::move(joint)).value();
    }
  }

  /// A floating joint's q is a pose in its frame F: where the body starts moves, not F.
  void move_base(Joint& joint) const {
    if (joint.type != JointType::kFloating || options_.onto != builder_.world()) {
      joint.X_PF = moved() * joint.X_PF;
      return;
    }
    for (std::vector<double>* const q : {&joint.initial, &joint.spring_reference}) move_pose(joint.X_PF, *q);
  }

  void move_pose(const Transform<double>& X_PF, std::vector<double>& q) const {
    Transform<double> X_FB = Transform<double>::identity();
    if (!q.empty()) X_FB = {to_matrix(normalized(Quat<double>{q[3], q[4], q[5], q[6]})), {q[0], q[1], q[2]}};
    X_FB = inverse(X_PF) * (moved() * (X_PF * X_FB));
    const Quat<double> r = to_quat(X_FB.R);
    q = {X_FB.p.x, X_FB.p.y, X_FB.p.z, r.x, r.y, r.z, r.w};
  }

  void add_geoms() {
    for (std::size_t i = 0; i < model_.geoms().size(); ++i) {
      Geom geom = model_.geoms()[i];
      if (!has(geom.link)) continue;
      if (geom.link.value() == 0) geom.X_LG = moved() * geom.X_LG;
      geom.name = named(geom.name);
      geom.link = link(geom.link);
      if (geom.shape.mesh.is_valid()) {
        MeshId& mesh = meshes_[geom.shape.mesh.index()];
        if (!mesh.is_valid()) mesh = builder_.add_mesh(model_.meshes()[geom.shape.mesh.index()]);
        geom.shape.mesh = mesh;
      }
      if (geom.shape.height_field.is_valid()) {
        HeightFieldId& field = fields_[geom.shape.height_field.index()];
        if (!field.is_valid()) {
          field = builder_.add_height_field(model_.height_fields()[geom.shape.height_field.index()]);
        }
        geom.shape.height_field = field;
      }
      map_.geoms[i] = builder_.add_geom(std::move(geom)).value();
    }
  }

  /// Tendons of which every part is there.
  void add_tendons() {
    for (std::size_t i = 0; i < model_.tendons().size(); ++i) {
      Tendon tendon = model_.tendons()[i];
      bool whole = true;
      for (TendonJoint& part : tendon.joints) {
        part.joint = JointId(map_.joints[part.joint.index()]);
        whole = whole && part.joint.is_valid();
      }
      for (TendonBranch& branch : tendon.branches) {
        for (TendonPoint& point : branch.points) {
          if (point.link.value() == 0) point.p_L = moved() * point.p_L;
          whole = whole && has(point.link);
          point.link = link(point.link);
        }
      }
      if (!whole) continue;
      tendon.name = named(tendon.name);
      map_.tendons[i] = builder_.add_tendon(std::move(tendon)).value();
    }
  }

  [[nodiscard]] TendonId tendon(TendonId id) const { return id.is_valid() ? TendonId(map_.tendons[id.index()]) : id; }

  /// Equality constraints that the model was given; those of mimic joints come from the joints again.
  void add_equalities() {
    const auto is_mimic = [&](const EqualityConstraint& equality) {
      return equality.type == EqualityType::kJoint && model_.joint(equality.joint_b).mimic &&
             equality.name == model_.joint(equality.joint_b).name + "_mimic";
    };
    for (EqualityConstraint equality : model_.equalities()) {
      if (is_mimic(equality)) continue;
      equality.name = named(equality.name);
      if (equality.type == EqualityType::kJoint || equality.type == EqualityType::kGear) {
        equality.joint_a = JointId(map_.joints[equality.joint_a.index()]);
        equality.joint_b = JointId(map_.joints[equality.joint_b.index()]);
        if (!equality.joint_a.is_valid() || !equality.joint_b.is_valid()) continue;
      } else if (equality.type == EqualityType::kTendon) {
        const bool has_a = equality.tendon_a.is_valid();
        equality.tendon_a = tendon(equality.tendon_a);
        equality.tendon_b = tendon(equality.tendon_b);
        if (!equality.tendon_b.is_valid() || equality.tendon_a.is_valid() != has_a) continue;
      } else {
        if (!has(equality.link_a) || !has(equality.link_b)) continue;
        if (equality.link_a.value() == 0) equality.X_LA = moved() * equality.X_LA;
        if (equality.link_b.value() == 0) equality.X_LB = moved() * equality.X_LB;
        equality.link_a = link(equality.link_a);
        equality.link_b = link(equality.link_b);
      }
      builder_.add_equality(std::move(equality));
    }
  }

  /// A frame on a link, in the new model; false if the link is left out.
  [[nodiscard]] bool place(LinkId& id, Transform<double>& X_LF) const {
    if (!has(id)) return false;
    if (id.value() == 0) X_LF = moved() * X_LF;
    id = link(id);
    return true;
  }

  [[nodiscard]] bool place_site(ActuatorSite& site) const {
    return place(site.link, site.X_LS) && (!site.reference.is_valid() || place(site.reference, site.X_LR));
  }

  /// Sensors of which every part is there.
  void add_sensors() {
    for (Sensor sensor : model_.sensors()) {
      const auto mapped = [](auto& id, const std::vector<int>& map) {
        using Id = std::remove_reference_t<decltype(id)>;
        if (!id.is_valid()) return true;
        id = Id(map[id.index()]);
        return id.is_valid();
      };
      const bool whole = mapped(sensor.joint, map_.joints) && mapped(sensor.tendon, map_.tendons) &&
                         mapped(sensor.actuator, map_.actuators) &&
                         (!sensor.link.is_valid() || place(sensor.link, sensor.X_LF)) &&
                         (!sensor.reference.is_valid() || place(sensor.reference, sensor.X_LR));
      if (!whole) continue;
      sensor.name = named(sensor.name);
      builder_.add_sensor(std::move(sensor));
    }
  }

  void add_actuators() {
    for (std::size_t i = 0; i < model_.actuators().size(); ++i) {
      Actuator actuator = model_.actuators()[i];
      if (actuator.joint.is_valid()) actuator.joint = JointId(map_.joints[actuator.joint.index()]);
      actuator.tendon = tendon(actuator.tendon);
      if (actuator.site && !place_site(*actuator.site)) continue;
      if (!actuator.joint.is_valid() && !actuator.tendon.is_valid() && !actuator.site) continue;
      actuator.name = named(actuator.name);
      map_.actuators[i] = builder_.add_actuator(std::move(actuator)).value();
    }
  }

  void add_contact_exceptions() {
    for (const ContactExclusion& exclusion : model_.exclusions()) {
      if (has(exclusion.a) && has(exclusion.b)) builder_.exclude_contact(link(exclusion.a), link(exclusion.b));
    }
    for (ContactPair pair : model_.contact_pairs()) {
      pair.a = GeomId(map_.geoms[pair.a.index()]);
      pair.b = GeomId(map_.geoms[pair.b.index()]);
      if (pair.a.is_valid() && pair.b.is_valid()) builder_.add_contact_pair(pair);
    }
  }

  /// Frames follow the body that carries them; one whose link on that body is gone goes with it.
  void add_frames() {
    for (std::size_t i = model_.links().size(); i < model_.frames().size(); ++i) {
      const Frame& frame = model_.frames()[i];
      const auto carries = [&](const Link& candidate) { return candidate.body == frame.body; };
      const auto carrier = std::ranges::find_if(model_.links(), carries);
      const LinkId id(static_cast<std::size_t>(carrier - model_.links().begin()));
      if (!has(id)) continue;
      const Transform<double> X_LF = inverse(carrier->X_BL) * frame.X_BF;
      builder_.add_frame(named(frame.name), link(id), id.value() == 0 ? moved() * X_LF : X_LF);
    }
  }

  ModelBuilder& builder_;
  const Model& model_;
  const AppendOptions& options_;
  PartMap map_;
  std::vector<MeshId> meshes_;
  std::vector<HeightFieldId> fields_;
};

}  // namespace

PartMap PartMap::then(const PartMap& next) const {
  return {chained(links, next.links), chained(joints, next.joints), chained(geoms, next.geoms),
          chained(actuators, next.actuators), chained(tendons, next.tendons)};
}

PartMap append(ModelBuilder& builder, const Model& model, const AppendOptions& options) {
  return Appender(builder, model, options).run();
}

ModelBuilder builder_of(const Model& model) {
  ModelBuilder builder(model.name());
  builder.set_gravity(model.gravity());
  builder.set_medium(model.medium());
  if (model.time_step()) builder.set_time_step(*model.time_step());
  builder.set_contact_rules(model.contact_rules());
  append(builder, model);
  return builder;
}

std::vector<std::pair<LinkId, LinkId>> self_collisions(const Model& model) {
  std::map<LinkId, std::vector<LinkId>> solid;  // by the root of their tree
  for (std::size_t i = 0; i < model.links().size(); ++i) {
    const auto collides = [&](GeomId id) { return model.geoms()[id.index()].role == GeomRole::kCollision; };
    if (std::ranges::any_of(model.geoms_of(LinkId(i)), collides)) {
      solid[model.root_link(LinkId(i))].push_back(LinkId(i));
    }
  }
  std::vector<std::pair<LinkId, LinkId>> found;
  for (const auto& [root, links] : solid) {
    for (std::size_t i = 0; i < links.size(); ++i) {
      for (std::size_t j = i + 1; j < links.size(); ++j) {
        if (model.link(links[i]).body != model.link(links[j]).body) found.emplace_back(links[i], links[j]);
      }
    }
  }
  return found;
}

void exclude_self_collision(ModelBuilder& builder, const Model& model, const PartMap& map) {
  for (const auto& [i, j] : self_collisions(model)) {
    const LinkId a(map.links[i.index()]), b(map.links[j.index()]);
    if (a.is_valid() && b.is_valid()) builder.exclude_contact(a, b);
  }
}

}  // namespace manyhands
