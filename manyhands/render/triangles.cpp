#include "manyhands/render/triangles.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "manyhands/base/hash.h"
#include "manyhands/base/index.h"
#include "manyhands/base/process_mutex.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace manyhands {

namespace {

using Vec = Vec3<float>;
using Corner = std::array<int, 3>;

constexpr float kSmooth = 0.766f;  // cosine of the angle below which an edge is none

/// One for the process, without threads of its own: those who render have theirs. Packets of eight run on the same code
/// on all machines that have it.
RTCDevice device() {
  struct Device {
    RTCDevice handle = rtcNewDevice("threads=1,set_affinity=0,max_isa=avx2");
    ~Device() { rtcReleaseDevice(handle); }
  };
  static const Device device;
  if (device.handle == nullptr) throw std::runtime_error("Embree does not start on this machine");
  return device.handle;
}

/// For each vertex, the first one at the same place: files repeat vertices where normals or textures differ.
std::vector<int> merged(const std::vector<Vec>& vertices) {
  std::vector<int> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) { return std::array{vertices[index(i)].x, vertices[index(i)].y, vertices[index(i)].z}; };
  std::ranges::sort(order, [&](int a, int b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool repeats = k > 0 && key(order[k]) == key(order[k - 1]);
    first[index(order[k])] = repeats ? first[index(order[k - 1])] : order[k];
  }
  return first;
}

Vec unit(const Vec& a) {
  const float length = norm(a);
  return length > 0 ? (1 / length) * a : Vec{0, 0, 1};
}

/// Twice the triangle's area, along its normal.
Vec area(const Triangles::Part& part, const Corner& t) {
  const Vec &a = part.vertices[index(t[0])], &b = part.vertices[index(t[1])], &c = part.vertices[index(t[2])];
  return cross(b - a, c - a);
}

std::vector<std::array<Vec, 3>> corner_normals(const Triangles::Part& part) {
  std::vector<Vec> areas;
  areas.reserve(part.triangles.size());
  for (const Corner& t : part.triangles) areas.push_back(area(part, t));
  std::vector<std::array<Vec, 3>> normals;
  if (!part.is_smooth) {
    for (const Vec& a : areas) normals.push_back({unit(a), unit(a), unit(a)});
    return normals;
  }
  const std::vector<int> first = merged(part.vertices);
  std::vector<std::vector<int>> around(part.vertices.size());
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    for (const int v : part.triangles[i]) around[index(first[index(v)])].push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    std::array<Vec, 3> corners{};
    const Vec own = unit(areas[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      Vec sum = areas[i];
      for (const int other : around[index(first[index(part.triangles[i][k])])]) {
        if (index(other) != i && dot(own, unit(areas[index(other)])) > kSmooth) sum += areas[index(other)];
      }
      corners[k] = unit(sum);
    }
    normals.push_back(corners);
  }
  return normals;
}

std::uint64_t hash_of(const std::vector<Triangles::Part>& parts) {
  Hash hash;
  for (const Triangles::Part& part : parts) {
    hash.add(part.vertices.size());
    hash.add(part.triangles.size());
    hash.add(part.is_smooth);
    for (const Vec& v : part.vertices) {
      for (const float x : {v.x, v.y, v.z}) hash.add(x);
    }
    for (const Corner& t : part.triangles) {
      for (const int v : t) hash.add(v);
    }
  }
  return hash.value();
}

}  // namespace

struct Triangles::Built {
  RTCScene scene = nullptr;
  ~Built() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }
};

std::shared_ptr<const Triangles> Triangles::of(std::vector<Part> parts) {
  static ProcessMutex mutex;
  static std::unordered_map<std::uint64_t, std::weak_ptr<const Triangles>> known;
  const std::uint64_t key = hash_of(parts);
  const std::scoped_lock lock(mutex);
  if (std::shared_ptr<const Triangles> found = known[key].lock()) return found;
  std::erase_if(known, [](const auto& entry) { return entry.second.expired(); });
  const std::shared_ptr<const Triangles> made(new Triangles(std::move(parts)));
  known[key] = made;
  return made;
}

Triangles::Triangles(std::vector<Part> parts) : parts_(std::move(parts)), built_(std::make_unique<Built>()) {
  built_->scene = rtcNewScene(device());
  rtcSetSceneFlags(built_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(built_->scene, RTC_BUILD_QUALITY_HIGH);
  for (Part& part : parts_) {
    normals_.push_back(corner_normals(part));
    const std::size_t vertices = part.vertices.size();
    part.vertices.push_back(Vec::zero());  // Embree reads up to 16 bytes from the start of the last vertex
    RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, part.vertices.data(), 0,
                               sizeof(Vec), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, part.triangles.data(), 0,
                               sizeof(Corner), part.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(built_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(built_->scene);
  if (const RTCError error = rtcGetDeviceError(device()); error != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree could not take in a mesh (its error " + std::to_string(error) + ")");
  }
}

Triangles::~Triangles() = default;

namespace {

template <class Ray>
MANYHANDS_INLINE void fill(Ray& ray, const RayPacket& rays) {
  store(ray.org_x, rays.o.x);
  store(ray.org_y, rays.o.y);
  store(ray.org_z, rays.o.z);
  store(ray.dir_x, rays.d.x);
  store(ray.dir_y, rays.d.y);
  store(ray.dir_z, rays.d.z);
  store(ray.tnear, rays.near);
  store(ray.tfar, rays.far);
  for (int k = 0; k < kRays; ++k) {
    ray.time[k] = 0;
    ray.mask[k] = ~0U;
    ray.id[k] = ray.flags[k] = 0;
  }
}

// Neighbouring rays of a small picture meet different triangles of a robot's fine meshes: one by one they are found
// half as fast again as in packets that stay together.
#if RTC_VERSION_MAJOR >= 4

template <class Arguments>
Arguments one_by_one(void (*set_defaults)(Arguments*)) {
  Arguments arguments;
  set_defaults(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  return arguments;
}

void intersect(const int* valid, RTCScene scene, RTCRayHit8& hit) {
  RTCIntersectArguments arguments = one_by_one(rtcInitIntersectArguments);
  rtcIntersect8(valid, scene, &hit, &arguments);
}

void occlude(const int* valid, RTCScene scene, RTCRay8& ray) {
  RTCOccludedArguments arguments = one_by_one(rtcInitOccludedArguments);
  rtcOccluded8(valid, scene, &ray, &arguments);
}

#else

RTCIntersectContext one_by_one() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

void intersect(const int* valid, RTCScene scene, RTCRayHit8& hit) {
  RTCIntersectContext context = one_by_one();
  rtcIntersect8(valid, scene, &context, &hit);
}

void occlude(const int* valid, RTCScene scene, RTCRay8& ray) {
  RTCIntersectContext context = one_by_one();
  rtcOccluded8(valid, scene, &context, &ray);
}

#endif

}  // namespace

RayMask Triangles::meet(RayPacket& rays, RayInts& part, RayInts& triangle) const {
  alignas(32) RTCRayHit8 hit;
  alignas(32) int valid[kRays];
  fill(hit.ray, rays);
  std::memcpy(valid, &rays.active.bits, sizeof(valid));
  std::ranges::fill(hit.hit.geomID, RTC_INVALID_GEOMETRY_ID);
  intersect(valid, built_->scene, hit);
  RayInts met_part, met_triangle;
  std::memcpy(&met_part, hit.hit.geomID, sizeof(met_part));
  std::memcpy(&met_triangle, hit.hit.primID, sizeof(met_triangle));
  const RayMask met = RayMask(met_part >= 0) & rays.active;
  rays.far = select(met, load<Rays>(hit.ray.tfar), rays.far);
  part = select(met, met_part, part);
  triangle = select(met, met_triangle, triangle);
  return met;
}

RayMask Triangles::blocks(const RayPacket& rays) const {
  alignas(32) RTCRay8 ray;
  alignas(32) int valid[kRays];
  fill(ray, rays);
  std::memcpy(valid, &rays.active.bits, sizeof(valid));
  occlude(valid, built_->scene, ray);
  return (load<Rays>(ray.tfar) < Rays(0.0f)) & rays.active;  // minus infinity where blocked
}

Triangles::Surface Triangles::surface(const TriangleHit& hit, const Vec& o, const Vec& d) const {
  const Part& part = parts_[index(hit.part)];
  const Corner& t = part.triangles[index(hit.triangle)];
  const Vec &a = part.vertices[index(t[0])], &b = part.vertices[index(t[1])], &c = part.vertices[index(t[2])];
  const Vec u = b - a, v = c - a, s = o - a, n = cross(u, v), q = cross(s, u);
  // Moeller and Trumbore, Fast, Minimum Storage Ray-Triangle Intersection, 1997.
  const float inverse = -1 / dot(n, d), beta = -(inverse * dot(cross(s, v), d)), gamma = inverse * dot(q, d);
  const std::array<Vec, 3>& corners = normals_[index(hit.part)][index(hit.triangle)];
  const Vec smooth = fma(1 - beta - gamma, corners[0], fma(beta, corners[1], gamma * corners[2]));
  return {inverse * dot(n, s), unit(smooth)};
}

}  // namespace manyhands
