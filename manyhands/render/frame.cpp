#include "manyhands/render/frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manyhands/render/triangles.h"

namespace manyhands {

namespace {

using Vec = Vec3<float>;

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr Rectangle kEverywhere{-kInfinite, kInfinite, -kInfinite, kInfinite};

void widen(Rectangle& r, float x, float y) { r = {min(r.left, x), max(r.right, x), min(r.top, y), max(r.bottom, y)}; }

/// Calls visit(corner) for the corners of the item's box, in I.
template <class Visit>
void for_each_corner(const Item& item, Visit&& visit) {
  for (int k = 0; k < 8; ++k) {
    visit(Vec{k & 1 ? item.high.x : item.low.x, k & 2 ? item.high.y : item.low.y, k & 4 ? item.high.z : item.low.z});
  }
}

void set_view(PlacedItem& placed, const Camera& camera) {
  placed.view = kEverywhere;
  placed.nearest = 0;
  if (placed.item->type == ShapeType::kPlane) return;
  const Transform<float> X_CI = inverse(placed.X_IC);
  const float fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const float cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  Rectangle covered{kInfinite, -kInfinite, kInfinite, -kInfinite};
  float nearest = kInfinite;
  for_each_corner(*placed.item, [&](const Vec& p_I) {
    const Vec p = X_CI * p_I;
    const float scale = camera.orthographic ? 1 : 1 / max(p.z, 1e-6f);
    widen(covered, fma(fx * p.x, scale, cx), fma(fy * p.y, scale, cy));
    nearest = min(nearest, p.z);
  });
  placed.nearest = nearest - 1e-4f * std::abs(nearest);
  // A box that reaches behind the camera has no such picture of its corners.
  if (nearest > 1e-3f || camera.orthographic) {
    placed.view = {covered.left - 0.5f, covered.right + 0.5f, covered.top - 0.5f, covered.bottom + 0.5f};
  }
}

void set_shade(PlacedItem& placed, const LightAxes& light) {
  placed.shade = {kInfinite, -kInfinite, kInfinite, -kInfinite};
  placed.height = -kInfinite;
  if (placed.item->type == ShapeType::kPlane) return;  // the light comes from above it
  for_each_corner(*placed.item, [&](const Vec& p_I) {
    const Vec p = placed.X_WI * p_I;
    widen(placed.shade, dot(light.x, p), dot(light.y, p));
    placed.height = max(placed.height, dot(light.z, p));
  });
}

/// By how much a mesh may be off before it can be seen in the picture [m].
float visible_error(const PlacedItem& placed, const Camera& camera, const Look& look) {
  constexpr float kInvisible = 0.4f;  // of the distance between samples
  const float focal = static_cast<float>(max(camera.fx, camera.fy) * look.antialiasing);
  return kInvisible * (camera.orthographic ? 1 : max(placed.nearest, static_cast<float>(camera.near))) / focal;
}

LightAxes axes_of(const Vec3<double>& direction) {
  const Vec3<double> z = (1 / norm(direction)) * direction;
  const Vec3<double> side = cross(std::abs(z.x) < 0.9 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0}, z);
  const Vec3<double> x = (1 / norm(side)) * side;
  return {broadcast<float>(x), broadcast<float>(cross(z, x)), broadcast<float>(z)};
}

Paint paint_of(const std::array<float, 4>& rgba, Pattern pattern = Pattern::kPlain, bool is_textured = false) {
  return {linear_light(rgba[0]),
          linear_light(rgba[1]),
          linear_light(rgba[2]),
          clamp(rgba[3], 0.0f, 1.0f),
          pattern,
          is_textured};
}

Paint paint_of(const Colour& c) { return paint_of({c[0], c[1], c[2], 1}); }

}  // namespace

void set_frame(PictureFrame& frame, const Scene& scene, const Camera& camera, const Look& look,
               std::span<const Transform<double>> X_WB, std::span<const Mark> marks, const Guise& guise,
               std::span<const Texture> textures) {
  frame.camera = camera;
  frame.look = look;
  frame.light = axes_of(look.light);
  frame.horizon = paint_of(look.horizon);
  frame.zenith = paint_of(look.zenith);
  Transform<double> X_WC = camera.X_FC;
  if (!camera.frame.empty()) {
    const Frame& mount = scene.model().frame(scene.model().frame_id(camera.frame));
    X_WC = X_WB[mount.body.index()] * mount.X_BF * camera.X_FC;
  }
  frame.X_WC = broadcast<float>(X_WC);
  frame.solid.clear();
  frame.clear.clear();
  frame.paint.clear();
  frame.textured.clear();

  const auto texture_of = [&](std::size_t geom) -> const Texture* {
    for (const std::span<const Texture> from : {std::span<const Texture>(guise.textures), textures}) {
      if (!from.empty() && from[geom].image != nullptr) return &from[geom];
    }
    return nullptr;
  };
  const auto place = [&](const Item& item, const Transform<double>& X_WI, int first_seen, bool is_clear) {
    PlacedItem placed{};
    placed.item = &item;
    placed.is_still = item.body == BodyId(0);
    placed.first_seen = first_seen;
    placed.X_WI = broadcast<float>(X_WI);
    placed.X_IC = broadcast<float>(inverse(X_WI) * X_WC);
    set_view(placed, camera);
    set_shade(placed, frame.light);
    placed.error = visible_error(placed, camera, look);
    if (item.triangles != nullptr) placed.shown = &item.triangles->within(placed.error);
    (is_clear ? frame.clear : frame.solid).push_back(placed);
  };
  for (const Seen& seen : scene.seen()) {
    const std::size_t geom = seen.geom.index();
    frame.paint.push_back(paint_of(guise.rgba.empty() ? seen.rgba : guise.rgba[geom],
                                   guise.patterns.empty() ? seen.pattern : guise.patterns[geom],
                                   texture_of(geom) != nullptr));
  }
  frame.own.clear();
  frame.own.reserve(scene.items().size() + marks.size());  // what is placed keeps its address
  for (const Item& item : scene.items()) {
    const Item* shown = &item;
    const std::size_t geom = scene.seen()[static_cast<std::size_t>(item.first_seen)].geom.index();
    if (item.triangles == nullptr && !guise.sizes.empty() && guise.sizes[geom].x > 0) {
      shown = &frame.own.emplace_back(item_of({.type = item.type, .size = guise.sizes[geom]}));
    }
    const Transform<double> X_WI = X_WB[item.body.index()] * broadcast<double>(item.X_BI);
    place(*shown, X_WI, item.first_seen, item.is_clear);
    for (int number = item.first_seen; number < item.first_seen + item.num_seen; ++number) {
      const Seen& seen = scene.seen()[static_cast<std::size_t>(number)];
      const Texture* const texture = texture_of(seen.geom.index());
      if (texture == nullptr) continue;
      const Vec low = item.triangles ? seen.low : shown->low, high = item.triangles ? seen.high : shown->high;
      const Vec rate{1 / (high.x - low.x), 1 / (high.y - low.y), 1 / (high.z - low.z)};
      frame.textured.push_back({number, item.type, low, high, rate, broadcast<float>(X_WI), texture});
    }
  }
  for (const Mark& mark : marks) {
    place(frame.own.emplace_back(item_of(mark.shape)), mark.X_WM, static_cast<int>(frame.paint.size()), true);
    frame.paint.push_back(paint_of(mark.rgba, mark.pattern));
  }
  std::ranges::stable_sort(frame.solid, [](const PlacedItem& a, const PlacedItem& b) {
    const bool simple_a = a.item->triangles == nullptr, simple_b = b.item->triangles == nullptr;
    if (a.is_still != b.is_still) return a.is_still;
    return simple_a != simple_b ? simple_a : a.nearest < b.nearest;
  });
  frame.num_still = static_cast<std::size_t>(std::ranges::count_if(frame.solid, &PlacedItem::is_still));
  std::ranges::stable_sort(frame.clear, [](const PlacedItem& a, const PlacedItem& b) { return a.nearest > b.nearest; });
}

}  // namespace manyhands
