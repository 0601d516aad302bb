// <worldbody>: bodies within bodies, each with its joints, mass, geoms and sites.
#include <algorithm>

#include "manyhands/model/io/mjcf/mjcf_writer.h"

namespace manyhands::io {

namespace {

class WorldWriter {
 public:
  explicit WorldWriter(MjcfWriter& writer) : writer_(writer), model_(writer.model) {
    for (const EqualityConstraint& e : model_.equalities()) {
      for (const LinkId link : {e.link_a, e.link_b}) {
        if (link.is_valid()) pinned_.insert(link);
      }
    }
    for (const ContactExclusion& exclusion : model_.exclusions()) pinned_.insert({exclusion.a, exclusion.b});
    // By joints, as they were added, then what stands in the world without one: the order of q.
    children_.resize(model_.links().size());
    for (const Joint& joint : model_.joints()) {
      if (!joint.name.empty()) children_[joint.parent.index()].push_back(joint.child);
    }
    for (std::size_t i = 1; i < model_.links().size(); ++i) {
      const Link& link = model_.links()[i];
      if (!link.joint.is_valid() && !link.name.empty()) children_[0].push_back(LinkId(i));
    }
  }

  void write() {
    writer_.carried_by[0] = LinkId(0);
    writer_.bodies[LinkId(0)].node = writer_.world;
    write_contents(writer_.world, LinkId(0));
    for (const LinkId child : children_[0]) write_link(LinkId(0), child);
  }

 private:
  [[nodiscard]] const Joint* joint_of(LinkId link) const {
    const JointId id = model_.link(link).joint;
    return id.is_valid() ? &model_.joint(id) : nullptr;
  }

  /// Whether bodies on such joints have none in MJCF.
  static bool is_jointless(JointType type) { return type == JointType::kFixed || type == JointType::kMocap; }

  /// Whether a link is nothing but the place where one joint ends and the next begins.
  [[nodiscard]] bool is_between(LinkId id) const {
    const Link& link = model_.link(id);
    const SymMat3<double>& I = link.inertial.inertia;
    const bool has_mass = link.inertial.mass != 0 || I.xx != 0 || I.yy != 0 || I.zz != 0;
    const Joint* const joint = joint_of(id);
    if (has_mass || joint == nullptr || is_jointless(joint->type)) return false;
    if (joint->type == JointType::kSpherical || joint->type == JointType::kFloating) return false;
    return model_.geoms_of(id).empty() && writer_.frames_of[id.index()].empty() && children_[id.index()].size() == 1 &&
           !pinned_.contains(id);
  }

  /// Whether the reader itself would hang `last` on `link` by this fixed joint: an anchor that is not the origin.
  [[nodiscard]] bool is_off_anchor(LinkId link, LinkId last) const {
    const Joint& fixed = *joint_of(last);
    const std::string& body = model_.link(last).name;
    return fixed.type == JointType::kFixed && same(fixed.X_PF.R, Mat3<double>::identity()) &&
           !same(fixed.X_PF.p, Vec3<double>::zero()) && fixed.name == body + "_fixed" &&
           model_.link(link).name == body + "_" + joint_of(link)->name;
  }

  /// The links whose joints become those of one body: those between, and the body's own.
  [[nodiscard]] std::vector<LinkId> links_of_body(LinkId first) const {
    std::vector<LinkId> links{first};
    while (is_between(links.back())) {
      const LinkId next = children_[links.back().index()][0];
      const JointType type = joint_of(next)->type;
      const bool joins = type == JointType::kFixed ? is_off_anchor(links.back(), next)
                                                   : type != JointType::kFloating && type != JointType::kPlanar;
      if (!joins) break;
      links.push_back(next);
    }
    return links;
  }

  void add_steps(MjcfChain& chain, const Joint& joint) const {
    const bool is_free = joint.type == JointType::kFloating && joint.parent == LinkId(0) &&
                         same(joint.X_PF.R, Mat3<double>::identity()) && same(joint.X_PF.p, Vec3<double>::zero());
    const double reference = velocity_size(joint.type) == 1 && !joint.initial.empty() ? joint.initial[0] : 0;
    const auto rest = [&](std::size_t i) { return joint.spring_reference.empty() ? 0.0 : joint.spring_reference[i]; };
    const bool is_single = velocity_size(joint.type) == 1;
    MjcfStep step{joint.name, joint.type, joint.X_PF, joint.axis, reference, &joint, is_single ? rest(0) : 0.0};
    if (step.type == JointType::kContinuous) step.type = JointType::kRevolute;
    const auto add = [&](const char* suffix, JointType type, const Vec3<double>& axis, double at, double at_rest) {
      chain.steps.push_back({joint.name + suffix, type, step.X_PF, axis, at, &joint, at_rest});
      step.X_PF = Transform<double>::identity();
    };
    const auto initial = [&](std::size_t i) { return joint.initial.empty() ? 0.0 : joint.initial[i]; };
    if (joint.type == JointType::kPlanar) {
      const Mat3<double> R_FZ = transpose(model_.link(joint.child).X_BL.R);
      writer_.notes.changed(part("joint", joint.name),
                            "MJCF has no planar joints; two slides and a hinge, with the same q");
      add("_x", JointType::kPrismatic, R_FZ.x, initial(0), rest(0));
      add("_y", JointType::kPrismatic, R_FZ.y, initial(1), rest(1));
      add("_angle", JointType::kRevolute, joint.axis, initial(2), rest(2));
    } else if (joint.type == JointType::kFloating && !is_free) {
      writer_.notes.changed(part("joint", joint.name),
                            "MJCF's free joints start from the world; three slides and a ball, with the same q");
      add("_x", JointType::kPrismatic, {1, 0, 0}, initial(0), rest(0));
      add("_y", JointType::kPrismatic, {0, 1, 0}, initial(1), rest(1));
      add("_z", JointType::kPrismatic, {0, 0, 1}, initial(2), rest(2));
      add("_ball", JointType::kSpherical, {0, 0, 1}, 0, 0);
    } else {
      chain.steps.push_back(std::move(step));
    }
    check_turn(joint, is_free);
    check_spring(joint, is_free);
  }

  /// The springs of balls are at rest unturned in MJCF, and those of free joints where the file places the body.
  void check_spring(const Joint& joint, bool is_free) const {
    const bool has_ball = joint.type == JointType::kSpherical || joint.type == JointType::kFloating;
    if (!has_ball || joint.stiffness == 0) return;
    const std::vector<double>& q = joint.spring_reference;
    const bool is_unturned = q.empty() || std::abs(q.back()) == 1;
    if (is_free ? q == joint.initial : is_unturned) return;
    writer_.notes.loss(LoadAction::kIgnored, part("joint", joint.name),
                       "its spring is at rest elsewhere than such springs are in MJCF");
  }

  /// A ball joint starts unturned in MJCF.
  void check_turn(const Joint& joint, bool is_free) const {
    const bool has_ball = joint.type == JointType::kSpherical || (joint.type == JointType::kFloating && !is_free);
    if (!has_ball || joint.initial.empty() || std::abs(joint.initial.back()) == 1) return;
    writer_.notes.loss(LoadAction::kIgnored, part("joint", joint.name),
                       "it starts turned, but MJCF's ball joints do not");
  }

  void write_link(LinkId parent, LinkId first) {
    constexpr int kMostNested = 125;  // elements in elements: XmlFile reads 128
    if (++depth_ > kMostNested)
      throw SaveError("links follow one another more than 125 deep, which readers of XML refuse");
    const std::vector<LinkId> links = links_of_body(first);
    const LinkId last = links.back();
    MjcfPlace around = writer_.bodies[parent];
    pugi::xml_node body = around.node.append_child("body");
    set(body, "name", writer_.names.claim("body", model_.link(last).name, "body", writer_.notes));
    set_unless(body, "gravcomp", model_.link(last).gravity_compensation, 0);
    for (const LinkId link : links) writer_.carried_by[link.index()] = last;
    MjcfChain chain;
    for (const LinkId link : links) {
      const Joint* const joint = joint_of(link);
      if (joint != nullptr && !is_jointless(joint->type)) add_steps(chain, *joint);
    }
    if (chain.steps.empty()) {
      place_jointless(chain, last);
      if (joint_of(last) != nullptr && joint_of(last)->type == JointType::kMocap) set(body, "mocap", "true");
    } else if (chain.steps[0].type == JointType::kFloating) {
      place_free(chain);
    } else {
      if (joint_of(last)->type == JointType::kFixed) chain.to_body = joint_of(last)->X_PF.p;
      note_between(links, place_chain(chain));
    }
    write_pose(body, chain.X_PB.p, chain.quat);
    writer_.bodies[last] = {body, around.X_WB * chain.X_PB};
    for (std::size_t i = 0; i < chain.steps.size(); ++i) write_joint(writer_, body, chain, i);
    write_inertial(body, model_.link(last));
    write_contents(body, last);
    for (const LinkId child : children_[last.index()]) write_link(last, child);
    --depth_;
  }

  void place_jointless(MjcfChain& chain, LinkId link) {
    const Joint* const joint = joint_of(link);
    const Transform<double>& X = joint == nullptr ? model_.link(link).X_BL : joint->X_PF;
    chain.quat = quat_for(X.R);
    chain.X_PB = {to_matrix(chain.quat), X.p};
    const std::string& name = model_.link(link).name;
    if (joint == nullptr) {
      writer_.notes.changed_alike("root", part("link", name), "it stands in the world; read as fixed by a joint");
    } else if (const std::string read = name + "_" + to_string(joint->type); joint->name != read) {
      writer_.notes.changed_alike("fixed", part("joint", joint->name),
                                  "such joints have no names in MJCF; called '" + read + "' where it is read");
    }
  }

  /// Where it is at the start is what places a free body.
  static void place_free(MjcfChain& chain) {
    const std::vector<double>& q = chain.steps[0].joint->initial;
    if (q.empty()) return;
    chain.quat = quat_for(Quat<double>{q[3], q[4], q[5], q[6]});
    chain.X_PB = {to_matrix(chain.quat), {q[0], q[1], q[2]}};
  }

  void note_between(const std::vector<LinkId>& links, bool is_parallel) const {
    const std::string& name = model_.link(links.back()).name;
    for (std::size_t i = 0; i + 1 < links.size(); ++i) {
      const Link& link = model_.link(links[i]);
      if (is_parallel && link.name == name + "_" + joint_of(links[i])->name) continue;
      writer_.notes.changed_alike("between", part("link", link.name),
                                  "without mass it is no body in MJCF, but a place between joints of '" + name + "'");
    }
  }

  void write_inertial(pugi::xml_node body, const Link& link) {
    const Inertial& inertial = link.inertial;
    const SymMat3<double>& I = inertial.inertia;
    const std::array<double, 6> entries{I.xx, I.yy, I.zz, I.xy, I.xz, I.yz};
    if (inertial.mass == 0 && std::ranges::all_of(entries, [](double x) { return x == 0; })) return;
    pugi::xml_node node = body.append_child("inertial");
    set(node, "pos", inertial.com);
    set(node, "mass", inertial.mass);
    if (I.xy == 0 && I.xz == 0 && I.yz == 0) {
      set(node, "diaginertia", std::span(entries).first(3));
    } else {
      set(node, "fullinertia", entries);
    }
  }

  void write_contents(pugi::xml_node body, LinkId link) {
    for (const GeomId id : model_.geoms_of(link)) write_geom(writer_, body, id);
    for (const int i : writer_.frames_of[link.index()]) {
      const Frame& frame = model_.frames()[static_cast<std::size_t>(i)];
      pugi::xml_node site = body.append_child("site");
      set(site, "name", writer_.names.claim("site", frame.name, "site", writer_.notes));
      write_pose(site, frame.X_LF);
    }
  }

  MjcfWriter& writer_;
  const Model& model_;
  int depth_ = 0;
  std::set<LinkId> pinned_;  ///< what other parts name
  std::vector<std::vector<LinkId>> children_;
};

}  // namespace

void write_world(MjcfWriter& writer) { WorldWriter(writer).write(); }

}  // namespace manyhands::io
