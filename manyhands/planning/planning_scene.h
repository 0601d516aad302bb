// What a planner reads of a scene: what moves with the planned joints, and what stands in its way.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/collision/queries/distance.h"
#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/planning/apart_map.h"
#include "manyhands/planning/ball_cover.h"
#include "manyhands/planning/obstacle_tree.h"

namespace manyhands {

/// A link that something carries: it and all parts of its mechanism move as one with the link `on`.
struct Attachment {
  LinkId link{}, on{};
};

/// Points that nothing may come near, as a camera sees them.
struct PointCloud {
  std::vector<Vec3<double>> points{};  ///< in the world [m]
  double radius = 0.01;                ///< of a ball about each [m]
};

struct SceneSettings {
  std::vector<JointId> joints{};                     ///< that are planned, of one coordinate each, in the order of q
  std::vector<Attachment> attached{};                ///< at the configuration at which the scene is made
  std::vector<std::pair<LinkId, LinkId>> allowed{};  ///< links that may touch
  std::vector<PointCloud> clouds{};
  std::vector<double> mocap{};  ///< poses of the mocap bodies, as State has them; empty: where the model has them
  double margin = 0;            ///< least distance that is kept [m]
  double overshoot = 0.02;      ///< by which balls stick out of links; smaller ones are more balls [m]
};

/// The joints that move a frame, as `SceneSettings::joints`. Throws ModelError as IkChain does.
[[nodiscard]] std::vector<JointId> joints_that_move(const Model& model, FrameId frame);

/// A ball in single precision, in the axes of the body that it moves with.
struct PartBall {
  Vec3<float> centre{};
  float radius{}, inner{};  ///< as Ball, with the margin; rounding is allowed for
};

/// A ball that holds others: those of a leaf, or of its two children.
struct BallNode {
  PartBall bound{};
  std::size_t first{}, last{};  ///< in MovingPart::balls
  std::size_t second = 0;       ///< its second child, in MovingPart::nodes; the first follows it. 0 for a leaf
};

/// A capsule that holds a part's balls, in the axes of the body: links are long, and their root balls always meet.
struct PartCapsule {
  Vec3<float> a{}, b{};  ///< ends of its axis [m]
  float radius{};
};

/// A shape as the exact check has it: on a body, or on the world.
struct SceneGeom {
  ShapeView shape{};
  Transform<double> X_BG = Transform<double>::identity();
  double radius{};         ///< of a ball about its origin that holds it; infinite for planes [m]
  std::size_t collider{};  ///< index in Colliders::geoms
};

/// Geoms of one link that the same rules hold for; it moves.
struct MovingPart {
  std::size_t body{};  ///< that it moves with
  LinkId link{};
  std::vector<SceneGeom> geoms{};
  std::vector<BallNode> nodes{};  ///< a tree of balls, the root first
  PartCapsule capsule{};
  std::vector<PartBall> balls{};
  std::vector<float>
      reach{};  ///< (n) [m/rad or 1]: how far a point of it moves, at most, per change of each coordinate
  std::vector<int> ignored{};  ///< obstacles that it may touch, sorted
};

/// Two parts that may not touch.
struct PartPair {
  std::size_t a{}, b{};        ///< where planned joints between move one of them alone, that is b
  std::vector<float> reach{};  ///< (n) as of parts, of each relative to the other
  bool moves_both = false;     ///< whether some joints between move a alone, and others b
  ApartMap apart{};            ///< if these are one or two
};

/// A collider that stands still.
struct Obstacle {
  LinkId link{};
  SceneGeom geom{};
};

/// Of a model at a configuration: the planned joints move parts, everything else stands. Immutable; knows nothing of
/// balls being checked in lanes, only what they are.
struct PlanningScene {
  /// q: (nq), of everything that is not planned, and at which things are attached. Throws std::invalid_argument if a
  /// joint has several coordinates, slides without limits, or drives or follows another one; if nothing that moves has
  /// a shape; and on numbers that are not finite.
  PlanningScene(const Model& model, std::span<const double> q, const SceneSettings& settings);

  [[nodiscard]] std::size_t size() const { return coordinates.size(); }  ///< n, planned coordinates
  /// q (nq) of the model at planned coordinates (n).
  [[nodiscard]] std::vector<double> configuration(std::span<const double> planned) const;
  /// The planned coordinates (n) of q (nq).
  [[nodiscard]] std::vector<double> planned(std::span<const double> whole) const;
  /// This scene with more points in the way: what is known of links and of other obstacles is not computed again.
  /// Throws std::invalid_argument on a radius of 0 or less, and on points that are not finite.
  [[nodiscard]] PlanningScene with_cloud(const PointCloud& cloud) const;
  /// Adds points; `tree_of_obstacles` is to be built after the last.
  void add(const PointCloud& cloud);
  /// (n) how far points of a body are from the axis of each joint that moves it, at most: the lengths of the links
  /// between, stretched out [m]; 1 for those that slide. `far` from its origin, `aside` from its axis [m].
  [[nodiscard]] std::vector<float> reach(std::size_t body, float far, float aside) const;
  /// The dof of planned coordinate k.
  [[nodiscard]] std::size_t dof(std::size_t k) const {
    return static_cast<std::size_t>(std::ranges::find(tree.dof_q, static_cast<int>(coordinates[k])) -
                                    tree.dof_q.begin());
  }
  [[nodiscard]] std::string link_name(LinkId link) const { return link_names[link.index()]; }

  Tree<double> tree;
  Tree<float> tree_in_float;
  Colliders<double> colliders;  ///< owns hulls and meshes that shapes point to
  std::vector<std::string> link_names;
  std::vector<std::string> joint_names;  ///< (n)
  std::vector<double> q;                 ///< (nq) of what is not planned
  std::vector<double> mocap;
  std::vector<std::size_t> coordinates;  ///< (n) of the planned joints, in q
  std::vector<double> lower, upper;      ///< (n) limits [rad or m]
  std::vector<double> velocity;          ///< (n) limits [rad/s or m/s]
  std::vector<std::size_t> bodies;       ///< that planned joints move, parents first
  std::vector<std::size_t> carriers;     ///< (bodies) what each moves with: what it is attached to, or itself
  std::vector<MovingPart> parts;
  std::vector<PartPair> pairs;
  std::vector<PartPair>
      pairs_apart;                  ///< whose joints cannot bring them as near as the margin: what is free need not ask
  std::vector<Obstacle> obstacles;  ///< owners of the pieces in `tree_of_obstacles`; after them come the clouds
  int clouds = 0;                   ///< how many
  ObstacleTree tree_of_obstacles;
  double margin, overshoot;  ///< as SceneSettings
};

/// Places all bodies where the scene has them, and returns its q (nq). `tree`: the scene's, in T's real numbers.
template <Number T>
[[nodiscard]] std::vector<T> place_scene(const PlanningScene& scene, const Tree<real_t<T>>& tree, Workspace<T>& ws) {
  const auto in_T = [](const std::vector<double>& numbers) {
    std::vector<T> found;
    for (const double x : numbers) found.push_back(constant<T>(x));
    return found;
  };
  std::vector<T> q = in_T(scene.q);
  place_mocap(tree, in_T(scene.mocap).data(), ws);
  forward_kinematics(tree, q.data(), ws);
  return q;
}

/// The balls that stand for what moves, at planned coordinates (n): x y z and radius each, in the world [m].
[[nodiscard]] std::vector<double> placed_balls(const PlanningScene& scene, std::span<const double> planned);

}  // namespace manyhands
