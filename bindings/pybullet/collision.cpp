// Contacts, distances, rays, and what may touch.
#include <tuple>
#include <utility>

#include "bindings/pybullet/arguments.h"

namespace manyhands::pybullet {

namespace {

PyObject* contact_of(const bullet::ContactReading& c) {
  return tuple(of(0), of(c.body_a), of(c.body_b), of(c.link_a), of(c.link_b), of(c.on_a), of(c.on_b), of(c.normal_on_b),
               of(c.distance), of(c.normal_force), of(c.friction_1), of(c.direction_1), of(c.friction_2),
               of(c.direction_2));
}

constexpr Function kContacts{
    "getContactPoints", "| bodyA=-1, bodyB=-1, linkIndexA=-2, linkIndexB=-2",
    "Where bodies touched in the last step: a tuple of 14 entries each - flag, bodies and links A and B, positions on "
    "A "
    "and on B, normal from B to A, distance, normal force, and two friction forces with their directions.",
    [](Client& client, const Arguments& a) -> PyObject* {
      return tuple_of(client.contacts(a.integer(0, -1), a.integer(1, -1), a.integer(2, -2), a.integer(3, -2)),
                      contact_of);
    }};

/// A body that is a collision shape, for as long as something is asked of it.
class ShapeBody {
 public:
  ShapeBody(Client& client, int shape, const Transform<double>& X) : client_(client) {
    if (shape >= 0) id_ = client.create_body({.collision_shape = shape}, X);
  }
  ~ShapeBody() {
    if (id_ >= 0) client_.remove(id_);
  }
  ShapeBody(const ShapeBody&) = delete;
  ShapeBody& operator=(const ShapeBody&) = delete;

  [[nodiscard]] int id_or(int body) const { return id_ >= 0 ? id_ : body; }
  [[nodiscard]] bool is(int body) const { return id_ >= 0 && id_ == body; }

 private:
  Client& client_;
  int id_ = -1;
};

PyObject* closest_points(Client& client, const Arguments& a) {
  const auto pose = [&](std::size_t position, std::size_t orientation) -> Transform<double> {
    return {a.rotation(orientation, "collision shape orientations need 4 numbers."),
            a.vec3(position, {0, 0, 0}, "collision shape positions need 3 numbers.")};
  };
  const ShapeBody shape_a(client, a.integer(5, -1), pose(7, 9)), shape_b(client, a.integer(6, -1), pose(8, 10));
  std::vector<bullet::ContactReading> points = client.closest_points(
      shape_a.id_or(a.integer(0)), shape_b.id_or(a.integer(1)), a.number(2), a.integer(3, -2), a.integer(4, -2));
  for (bullet::ContactReading& point : points) {
    if (shape_a.is(point.body_a)) std::tie(point.body_a, point.link_a) = std::pair(-1, a.integer(3, -2));
    if (shape_b.is(point.body_b)) std::tie(point.body_b, point.link_b) = std::pair(-1, a.integer(4, -2));
  }
  return tuple_of(points, contact_of);
}

constexpr Function kClosest{
    "getClosestPoints",
    "bodyA, bodyB, distance | linkIndexA=-2, linkIndexB=-2, collisionShapeA=-1, collisionShapeB=-1, "
    "collisionShapePositionA=None, collisionShapePositionB=None, collisionShapeOrientationA=None, "
    "collisionShapeOrientationB=None",
    "The nearest points of the links of two bodies that are at most `distance` apart, where they are now; as "
    "getContactPoints, without forces. A collision shape takes the place of a body, whose id is then -1.",
    closest_points};

PyObject* ray_of(const bullet::RayReading& r) {
  return tuple(of(r.body), of(r.link), of(r.fraction), of(r.point), of(r.normal));
}

constexpr Function kRay{
    "rayTest", "rayFromPosition, rayToPosition | collisionFilterMask=-1, reportHitNumber=-1",
    "What a ray meets first: a tuple of one entry - body, link, share of the way, position, normal; "
    "body -1 where it meets nothing. reportHitNumber: how many links to pass; Bullet's order of them is arbitrary.",
    [](Client& client, const Arguments& a) -> PyObject* {
      const Vec3<double> from = a.vec3(0, "rayFromPosition needs 3 numbers."),
                         to = a.vec3(1, "rayToPosition needs 3 numbers.");
      return tuple_of(
          client.cast_rays(std::span(&from, 1), std::span(&to, 1), a.integer(2, -1), std::max(a.integer(3, -1), 0)),
          ray_of);
    }};

PyObject* cast_batch(Client& client, const Arguments& a) {
  constexpr std::size_t kMost = 16384;
  std::vector<Vec3<double>> from = a.points(0, "rayFromPositions needs a list of 3 numbers each."),
                            to = a.points(1, "rayToPositions needs a list of 3 numbers each.");
  if (from.size() != to.size()) throw Error("Size of from_positions need to be equal to size of to_positions.");
  if (from.size() > kMost) throw Error("Number of rays exceed the maximum batch size.");
  if (const int parent = a.integer(3, -1); parent >= 0) {
    const int link = a.integer(4, -1);
    const Transform<double> X = link < 0 ? client.base_pose(parent) : client.link_state(parent, link).X_WI;
    for (Vec3<double>& p : from) p = X * p;
    for (Vec3<double>& p : to) p = X * p;
  }
  return tuple_of(client.cast_rays(from, to, a.integer(6, -1), std::max(a.integer(5, -1), 0)), ray_of);
}

constexpr Function kRays{
    "rayTestBatch",
    "rayFromPositions, rayToPositions | numThreads=1, parentObjectUniqueId=-1, parentLinkIndex=-1, "
    "reportHitNumber=-1, collisionFilterMask=-1, fractionEpsilon=0",
    "As rayTest, of up to 16384 rays, in the world or in the frame of a parent.", cast_batch};

constexpr Function kOverlap{"getOverlappingObjects", "aabbMin, aabbMax",
                            "(body, link) of all links whose boxes meet this one; None if there are none.",
                            [](Client& client, const Arguments& a) -> PyObject* {
                              const auto found = client.overlapping(
                                  {a.vec3(0, "aabbMin needs 3 numbers."), a.vec3(1, "aabbMax needs 3 numbers.")});
                              if (found.empty()) return none();
                              return tuple_of(found, [](const auto& one) { return tuple(of(one[0]), of(one[1])); });
                            }};

constexpr Function kPair{
    "setCollisionFilterPair", "bodyUniqueIdA, bodyUniqueIdB, linkIndexA, linkIndexB, enableCollision",
    "Whether two links may touch, whatever their groups.", [](Client& client, const Arguments& a) -> PyObject* {
      client.set_collision_pair(a.integer(0), a.integer(1), a.integer(2), a.integer(3), a.integer(4) != 0);
      return none();
    }};

constexpr Function kGroup{"setCollisionFilterGroupMask",
                          "bodyUniqueId, linkIndexA, collisionFilterGroup, collisionFilterMask",
                          "The groups that a link belongs to, and those that it touches.",
                          [](Client& client, const Arguments& a) -> PyObject* {
                            client.set_collision_mask(a.integer(0), a.integer(1), a.integer(2), a.integer(3));
                            return none();
                          }};

}  // namespace

void add_collision(Methods& methods) {
  add_to<kContacts>(methods);
  add_to<kClosest>(methods);
  add_to<kRay>(methods);
  add_to<kRays>(methods);
  add_to<kOverlap>(methods);
  add_to<kPair>(methods);
  add_to<kGroup>(methods);
}

}  // namespace manyhands::pybullet
