// A scene at one moment, seen by one camera: what rays need, prepared once for a picture. Internal to the renderer.
#pragma once

#include "manyhands/render/camera.h"
#include "manyhands/render/look.h"
#include "manyhands/render/raster.h"
#include "manyhands/render/scene.h"
#include "manyhands/render/texture_place.h"

namespace manyhands {

/// A rectangle; of pixels, or across the light.
struct Rectangle {
  float left, right, top, bottom;
  [[nodiscard]] bool meets(const Rectangle& other) const {
    return left <= other.right && other.left <= right && top <= other.bottom && other.top <= bottom;
  }
};

[[nodiscard]] inline Rectangle widened(const Rectangle& r, float by) {
  return {r.left - by, r.right + by, r.top - by, r.bottom + by};
}

[[nodiscard]] inline Rectangle united(const Rectangle& a, const Rectangle& b) {
  return {min(a.left, b.left), max(a.right, b.right), min(a.top, b.top), max(a.bottom, b.bottom)};
}

/// An item where it is.
struct PlacedItem {
  const Item* item;
  int first_seen;                      ///< in the palette of the frame
  bool is_still;                       ///< it stands in the world and cannot move
  float error;                         ///< by how much a mesh may be off in colours [m]
  const ClusteredMesh *shown, *casts;  ///< of meshes: what is drawn in colours, and what casts shadows
  Transform<float> X_WI, X_IC;
  Rectangle view;   ///< the pixels that it may cover
  float nearest;    ///< no part has a smaller depth [m]
  Rectangle shade;  ///< the shadow it may cast, across the light [m]
  float height;     ///< its highest point towards the light [m]
};

/// What colour a geom has: linear light, not as screens take it.
struct Paint {
  float red, green, blue, alpha;
  Pattern pattern;
  bool is_textured = false;
};

/// Axes across the light, and towards it.
struct LightAxes {
  Vec3<float> x, y, z;
};

/// One point of the sun: what of meshes it shines on, in a grid across its light. It stands still in the world, so that
/// what is drawn there does not depend on the rest of the picture.
struct SunPoint {
  Vec3<float> towards;       ///< unit, in the world
  Vec3<float> across, down;  ///< column and row of a point in the world [1/m]
  Raster nearest;            ///< heights towards the light [m]
};

struct PictureFrame {
  Camera camera;
  Look look;
  Transform<float> X_WC;
  LightAxes light;
  Paint horizon, zenith;
  std::vector<PlacedItem> solid;  ///< what stands still first, of that simple shapes; each kind from the nearest on
  std::size_t num_still;          ///< of the solid ones
  std::vector<PlacedItem> clear;  ///< from the farthest on
  std::vector<Paint> paint;       ///< by number of `Seen`; marks follow
  std::vector<Item> own;          ///< items of this picture alone: marks, and shapes of other sizes
  std::vector<TexturedSurface> textured;
  float texel;                 ///< side of a square of the suns' grids [m]
  std::vector<SunPoint> suns;  ///< empty where there are no shadows

  /// The solid items that stand still, or those that may move.
  [[nodiscard]] std::span<const PlacedItem> solid_items(bool still) const {
    return still ? std::span(solid).first(num_still) : std::span(solid).subspan(num_still);
  }
};

/// X_WB: poses of the model's bodies (bodies). textures: the model's own, one for each geom, or none at all. All
/// numbers must fit, which the renderer checks. Frames are used again and again, so that their memory is.
void set_frame(PictureFrame& frame, const Scene& scene, const Camera& camera, const Look& look,
               std::span<const Transform<double>> X_WB, std::span<const Mark> marks, const Guise& guise,
               std::span<const Texture> textures);

}  // namespace manyhands
