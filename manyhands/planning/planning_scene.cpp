#include "manyhands/planning/planning_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "manyhands/kinematics/inverse_kinematics.h"
#include "manyhands/math/philox.h"
#include "manyhands/physics/collision/broad/bounds_meet.h"
#include "manyhands/physics/collision/surface/height_grid.h"
#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/planning/checks.h"
#include "manyhands/planning/exact_check.h"
#include "manyhands/planning/part_balls.h"

namespace manyhands {

namespace {

using Vec = Vec3<double>;

constexpr double kHalfTurn = std::numbers::pi;  // how far joints without limits go to either side [rad]
constexpr double kTouchesHeld = 1e-3;           // what is held touches what is nearer than this [m]

/// Puts the scene together.
class SceneMaker {
 public:
  SceneMaker(const Model& model, const SceneSettings& settings, PlanningScene& scene)
      : model_(model), settings_(settings), scene_(scene), params_(model), ws_(scene.tree) {}

  void make() {
    scene_.colliders.rules.self_collision = true;  // models leave it out for the step's sake
    place_all();
    choose_joints();
    find_carriers();
    sort_geoms();
    if (scene_.parts.empty()) throw std::invalid_argument("nothing that the planned joints move has a collision shape");
    for (MovingPart& part : scene_.parts) {
      internal::cover(part, settings_.margin, settings_.overshoot);
      set_reach(part);
    }
    for (const PointCloud& cloud : settings_.clouds) scene_.add(cloud);
    scene_.tree_of_obstacles.build();
    find_ignored();
    find_pairs();
    leave_out_pairs();
  }

 private:
  using Key = std::tuple<std::size_t, std::size_t, std::uint32_t, std::uint32_t>;

  void place_all() {
    place_mocap(scene_.tree, scene_.mocap.data(), ws_);
    forward_kinematics(scene_.tree, scene_.q.data(), ws_);
  }

  void choose_joints() {
    if (settings_.joints.empty()) throw std::invalid_argument("no joints are planned; name one or more");
    std::vector<JointId> joints = settings_.joints;
    std::ranges::sort(joints, {}, [&](JointId id) { return model_.joint(id).iq; });
    const auto [again, end] = std::ranges::unique(joints);
    joints.erase(again, end);
    is_planned_.assign(scene_.tree.bodies.size(), false);
    for (const JointId id : joints) {
      const Joint& joint = model_.joint(id);
      require_plannable(id, joint);
      scene_.joint_names.push_back(joint.name);
      scene_.coordinates.push_back(static_cast<std::size_t>(joint.iq));
      scene_.lower.push_back(joint.limits.lower);
      scene_.upper.push_back(joint.limits.upper);
      scene_.velocity.push_back(joint.limits.velocity);
      const std::size_t body = model_.link(joint.child).body.index();
      is_planned_[body] = true;
      body_of_.push_back(body);
    }
    moves_.assign(is_planned_.size(), false);
    for (std::size_t b = 1; b < moves_.size(); ++b) {
      moves_[b] = is_planned_[b] || moves_[parent(b)];
      if (moves_[b]) scene_.bodies.push_back(b);
    }
  }

  void require_plannable(JointId id, const Joint& joint) const {
    const auto refuse = [&](const std::string& why) {
      throw std::invalid_argument("joint '" + joint.name + "' cannot be planned: " + why);
    };
    if (joint.type == JointType::kFixed || configuration_size(joint.type) != 1)
      refuse("it has " + std::to_string(configuration_size(joint.type)) + " coordinates; planned joints have one");
    if (joint.type == JointType::kPrismatic &&
        !(std::isfinite(joint.limits.lower) && std::isfinite(joint.limits.upper)))
      refuse("it slides without limits; give it some");
    for (const EqualityConstraint& e : model_.equalities()) {
      const bool couples = e.type == EqualityType::kJoint || e.type == EqualityType::kGear;
      if (couples && (e.joint_a == id || e.joint_b == id))
        refuse("'" + model_.joint(e.joint_a).name + "' and '" + model_.joint(e.joint_b).name + "' drive each other");
    }
  }

  [[nodiscard]] std::size_t parent(std::size_t body) const {
    return static_cast<std::size_t>(scene_.tree.bodies[body].parent);
  }

  void find_carriers() {
    scene_.carriers.resize(moves_.size());
    for (std::size_t b = 0; b < moves_.size(); ++b) scene_.carriers[b] = b;
    for (const Attachment& attachment : settings_.attached) {
      const std::size_t held = model_.link(attachment.link).body.index(), on = model_.link(attachment.on).body.index();
      const std::string names =
          "'" + model_.link(attachment.link).name + "' to '" + model_.link(attachment.on).name + "'";
      if (held == 0) throw std::invalid_argument("cannot attach " + names + ": it is fixed to the world");
      if (!moves_[on]) throw std::invalid_argument("cannot attach " + names + ": the planned joints do not move that");
      std::size_t root = held;
      while (parent(root) != 0) root = parent(root);
      if (moves_[held] || is_above(root, on))
        throw std::invalid_argument("cannot attach " + names + ": the planned joints move it already");
      for (std::size_t b = root; b < moves_.size(); ++b) {
        if (is_above(root, b)) scene_.carriers[b] = on;
      }
    }
  }

  [[nodiscard]] bool is_above(std::size_t ancestor, std::size_t body) const {
    while (body != 0 && body != ancestor) body = parent(body);
    return body == ancestor;
  }

  void sort_geoms() {
    std::map<Key, std::size_t> part_of;
    for (std::size_t i = 0; i < scene_.colliders.geoms.size(); ++i) {
      const Collider<double>& geom = scene_.colliders.geoms[i];
      const std::size_t body = scene_.carriers[geom.body];
      const Transform<double> X_WG = body_pose(geom.body, ws_) * geom.X_BG;
      SceneGeom placed = {.shape = {geom.type, model_.geoms()[geom.geom].shape.size, geom.hull.get(), geom.mesh.get(),
                                    geom.height_field.get()},
                          .X_BG = X_WG,
                          .radius = bounding_radius(geom, model_.geoms()[geom.geom].shape.size),
                          .collider = i};
      if (!moves_[body]) {
        scene_.obstacles.push_back({LinkId(static_cast<int>(geom.link)), placed});
        add_pieces(static_cast<int>(scene_.obstacles.size()) - 1, placed, X_WG);
        continue;
      }
      placed.X_BG = inverse(body_pose(body, ws_)) * X_WG;
      const Key key{geom.link, body, geom.filter.group, geom.filter.mask};
      const auto [found, is_new] = part_of.try_emplace(key, scene_.parts.size());
      if (is_new) scene_.parts.push_back({.body = body, .link = LinkId(static_cast<int>(geom.link))});
      scene_.parts[found->second].geoms.push_back(placed);
    }
  }

  void add_pieces(int owner, const SceneGeom& geom, const Transform<double>& X_WG) {
    if (const TriangleMesh* mesh = geom.shape.mesh) {
      for (std::size_t i = 0; i < mesh->size(); ++i) add_triangle(owner, mesh->triangle(i).corner, X_WG);
    } else if (const HeightField* field = geom.shape.field) {
      const HeightGrid grid(*field);
      for (int row = 0; row + 1 < field->rows; ++row) {
        for (int column = 0; column + 1 < field->columns; ++column) {
          for (int half = 0; half < 2; ++half) add_triangle(owner, grid.triangle(column, row, half).corner, X_WG);
        }
      }
    } else {
      scene_.tree_of_obstacles.add(owner, {.type = geom.shape.type, .size = geom.shape.size}, geom.shape.hull, X_WG);
    }
  }

  void add_triangle(int owner, const std::array<Vec, 3>& corner, const Transform<double>& X_WG) {
    scene_.tree_of_obstacles.add_triangle(owner, {X_WG * corner[0], X_WG * corner[1], X_WG * corner[2]});
  }

  void set_reach(MovingPart& part) const {
    float far = 0, aside = 0;  // of its points from the body's origin, and from its axis
    for (const PartBall& ball : part.balls) {
      far = max(far, norm(ball.centre) + ball.radius);
      aside = max(aside, std::hypot(ball.centre.x, ball.centre.y) + ball.radius);
    }
    part.reach = scene_.reach(part.body, far, aside);
  }

  [[nodiscard]] std::size_t index_of(std::size_t planned_body) const {
    return static_cast<std::size_t>(std::ranges::find(body_of_, planned_body) - body_of_.begin());
  }

  [[nodiscard]] bool may_touch(const SceneGeom& a, LinkId link_a, const SceneGeom& b, LinkId link_b) const {
    for (const auto& [x, y] : settings_.allowed) {
      if ((x == link_a && y == link_b) || (x == link_b && y == link_a)) return false;
    }
    return scene_.colliders.pair_of(a.collider, b.collider).has_value();
  }

  /// The distance of a part from a shape, at the configuration of the scene.
  [[nodiscard]] double distance(const MovingPart& part, const SceneGeom& other, const Transform<double>& X_WO) const {
    double least = std::numeric_limits<double>::infinity();
    const Transform<double> X_WB = body_pose(part.body, ws_);
    for (const SceneGeom& geom : part.geoms)
      least = std::min(least, signed_distance(geom.shape, X_WB * geom.X_BG, other.shape, X_WO).phi);
    return least;
  }

  [[nodiscard]] bool is_held(const MovingPart& part) const { return model_.link(part.link).body.index() != part.body; }

  void find_pairs() {
    for (std::size_t a = 0; a < scene_.parts.size(); ++a) {
      for (std::size_t b = a + 1; b < scene_.parts.size(); ++b) {
        const MovingPart &x = scene_.parts[a], &y = scene_.parts[b];
        if (x.body == y.body || !may_touch(x.geoms[0], x.link, y.geoms[0], y.link)) continue;
        if ((is_held(x) || is_held(y)) && touches(x, y)) continue;
        PartPair pair{a, b, std::vector<float>(scene_.size())};
        bool a_moves = false, b_moves = false;
        for (std::size_t k = 0; k < scene_.size(); ++k) {
          const bool moves_a = is_above(body_of_[k], x.body), moves_b = is_above(body_of_[k], y.body);
          pair.reach[k] = moves_a == moves_b ? 0.0f : moves_a ? x.reach[k] : y.reach[k];
          a_moves = a_moves || (moves_a && !moves_b);
          b_moves = b_moves || (moves_b && !moves_a);
        }
        pair.moves_both = a_moves && b_moves;
        if (a_moves && !b_moves) std::swap(pair.a, pair.b);
        scene_.pairs.push_back(std::move(pair));
      }
    }
  }

  [[nodiscard]] bool touches(const MovingPart& x, const MovingPart& y) const {
    const Transform<double> X_WB = body_pose(y.body, ws_);
    return std::ranges::any_of(
        y.geoms, [&](const SceneGeom& geom) { return distance(x, geom, X_WB * geom.X_BG) < kTouchesHeld; });
  }

  /// Leaves out the pairs that no joint between moves, and those of sloppy models that always touch; sets those apart
  /// that planned joints cannot bring as near as the margin.
  void leave_out_pairs() {
    internal::ExactCheck exact(scene_);
    std::vector<PartPair> kept;
    for (PartPair& pair : scene_.pairs) {
      if (std::ranges::all_of(pair.reach, [](float reach) { return reach == 0; })) continue;
      pair.apart = internal::apart_map(scene_, pair, exact);
      if (pair.apart.is_apart_everywhere())
        scene_.pairs_apart.push_back(std::move(pair));
      else if (!always_overlaps(exact, pair))
        kept.push_back(std::move(pair));
    }
    scene_.pairs = std::move(kept);
  }

  [[nodiscard]] bool always_overlaps(internal::ExactCheck& exact, const PartPair& pair) const {
    constexpr int kLooks = 50;
    std::vector<double> q = scene_.planned(scene_.q);
    RandomStream random(0, 3, 0);
    for (int look = 0; look < kLooks; ++look) {
      exact.place(q);
      if (exact.distance(pair, 0) >= 0) return false;
      for (std::size_t k = 0; k < q.size(); ++k)
        q[k] = random.uniform(std::max(scene_.lower[k], -kHalfTurn), std::min(scene_.upper[k], kHalfTurn));
    }
    return true;
  }

  void find_ignored() {
    for (MovingPart& part : scene_.parts) {
      for (std::size_t i = 0; i < scene_.obstacles.size(); ++i) {
        const Obstacle& obstacle = scene_.obstacles[i];
        if (!may_touch(part.geoms[0], part.link, obstacle.geom, obstacle.link))
          part.ignored.push_back(static_cast<int>(i));
      }
    }
  }

  const Model& model_;
  const SceneSettings& settings_;
  PlanningScene& scene_;
  ParamsStorage<double> params_;
  Workspace<double> ws_;
  std::vector<bool> is_planned_, moves_;  // (bodies)
  std::vector<std::size_t> body_of_;      // (n) that a planned joint moves
};

}  // namespace

PlanningScene::PlanningScene(const Model& model, std::span<const double> q_now, const SceneSettings& settings)
    : tree(model),
      tree_in_float(model),
      colliders(model, PairSearch::kSwept),
      q(q_now.begin(), q_now.end()),
      mocap(settings.mocap.empty() ? model.initial_mocap() : settings.mocap),
      margin(settings.margin),
      overshoot(settings.overshoot) {
  require_rows("q", q_now, 1, static_cast<std::size_t>(model.nq()));
  require_rows("mocap", mocap, 1, model.mocap_bodies().size() * kPoseNumbers);
  if (!(margin >= 0 && std::isfinite(margin)))
    throw std::invalid_argument("margin is " + as_text(margin) + " m; expected 0 or more");
  if (!(settings.overshoot > 0 && std::isfinite(settings.overshoot)))
    throw std::invalid_argument("overshoot is " + as_text(settings.overshoot) + " m; expected more than 0");
  for (const Link& link : model.links()) link_names.push_back(link.name);
  SceneMaker(model, settings, *this).make();
}

std::vector<JointId> joints_that_move(const Model& model, FrameId frame) {
  std::vector<JointId> joints;
  for (const std::size_t dof : IkChain(model, frame).dofs) joints.emplace_back(model.dof_joint()[dof]);
  return joints;
}

void PlanningScene::add(const PointCloud& cloud) {
  if (!(cloud.radius > 0 && std::isfinite(cloud.radius)))
    throw std::invalid_argument("the cloud's radius is " + as_text(cloud.radius) + " m; expected more than 0");
  if (!cloud.points.empty()) require_finite("cloud", std::span(&cloud.points[0].x, 3 * cloud.points.size()), 3);
  const int owner = static_cast<int>(obstacles.size()) + clouds++;
  for (const Vec& p : cloud.points) tree_of_obstacles.add_point(owner, p, cloud.radius);
}

PlanningScene PlanningScene::with_cloud(const PointCloud& cloud) const {
  PlanningScene more = *this;
  more.add(cloud);
  more.tree_of_obstacles.build();
  return more;
}

std::vector<float> PlanningScene::reach(std::size_t of_body, float far, float aside) const {
  std::vector<float> found(size(), 0.0f);
  for (std::size_t b = of_body; b != 0; b = static_cast<std::size_t>(tree.bodies[b].parent)) {
    const TreeBody<double>& body = tree.bodies[b];
    const auto iq = static_cast<std::size_t>(body.iq);
    const auto k = static_cast<std::size_t>(std::ranges::find(coordinates, iq) - coordinates.begin());
    const bool slides = body.type == JointType::kPrismatic, is_planned = body.nv > 0 && k < size();
    if (is_planned) found[k] = slides ? 1.0f : aside;
    const double longest = is_planned ? std::max(std::abs(lower[k]), std::abs(upper[k])) : slides ? std::abs(q[iq]) : 0;
    const float slide = slides ? static_cast<float>(longest) : 0.0f;
    const Vec3<float> p = broadcast<float>(body.X_PF.p);
    aside = std::hypot(p.x, p.y) + slide + far;
    far = norm(p) + slide + far;
  }
  return found;
}

std::vector<double> PlanningScene::configuration(std::span<const double> planned) const {
  std::vector<double> whole = q;
  for (std::size_t k = 0; k < planned.size(); ++k) whole[coordinates[k]] = planned[k];
  return whole;
}

std::vector<double> PlanningScene::planned(std::span<const double> whole) const {
  std::vector<double> chosen;
  for (const std::size_t k : coordinates) chosen.push_back(whole[k]);
  return chosen;
}

std::vector<double> placed_balls(const PlanningScene& scene, std::span<const double> planned) {
  Workspace<double> ws(scene.tree);
  place_mocap(scene.tree, scene.mocap.data(), ws);
  forward_kinematics(scene.tree, scene.configuration(planned).data(), ws);
  std::vector<double> found;
  for (const MovingPart& part : scene.parts) {
    for (const PartBall& ball : part.balls) {
      const Vec p = body_pose(part.body, ws) * broadcast<double>(ball.centre);
      found.insert(found.end(), {p.x, p.y, p.z, static_cast<double>(ball.radius)});
    }
  }
  return found;
}

}  // namespace manyhands
