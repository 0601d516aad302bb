// Client: colours, textures and pictures.
#include <algorithm>
#include <cmath>

#include "manyhands/bullet/client_body.h"
#include "manyhands/render/renderer.h"

namespace manyhands::bullet {

void Client::change_visual(int id, int link, const VisualChange& change) {
  Body* const body = find(id);
  if (body == nullptr || !body->has_link(link)) return;
  LinkMemory& memory = body->of(link);
  ++looks_;
  for (std::size_t k = 0; k < memory.rgba.size(); ++k) {
    if (change.shape >= 0 && static_cast<std::size_t>(change.shape) != k) continue;
    if (change.rgba) memory.rgba[k] = *change.rgba;
    if (change.texture) memory.textures[k] = *change.texture;
  }
}

const std::array<float, 4>& Client::rgba(int id, int link, std::size_t shape) const {
  return at(id, "there is no such body").of(link).rgba[shape];
}

int Client::texture(int id, int link, std::size_t shape) const {
  return at(id, "there is no such body").of(link).textures[shape];
}

int Client::add_texture(std::shared_ptr<const Image> image) {
  const int id = textures_.empty() ? 0 : textures_.rbegin()->first + 1;
  textures_[id] = std::move(image);
  return id;
}

void Client::change_texture(int id, std::shared_ptr<const Image> image) {
  if (const auto found = textures_.find(id); found != textures_.end()) found->second = std::move(image);
}

namespace {

/// A camera from PyBullet's matrices, at (near, far).
Camera camera_of(const PictureRequest& request) {
  return camera_from_matrices(request.width, request.height, request.view, request.projection);
}

/// What OpenGL's buffer holds for a depth [m].
float buffer_depth(const Camera& camera, float z) {
  const double n = camera.near, f = camera.far;
  if (!(z < f)) return 1;
  if (camera.orthographic) return static_cast<float>((z - n) / (f - n));
  return static_cast<float>(f * (z - n) / (z * (f - n)));
}

}  // namespace

/// The model's geoms as they look now: colours, and textures that were changed.
Guise Client::guise_of(const Model& model) {
  Guise guise;
  guise.rgba.resize(model.geoms().size());
  for (std::size_t i = 0; i < guise.rgba.size(); ++i) guise.rgba[i] = model.geoms()[i].rgba;
  for (const int id : order_) {
    Body& body = *find(id);
    for (int link = -1; link < body.plan.num_links(); ++link) {
      const LinkMemory& memory = body.of(link);
      std::size_t k = 0;
      for (const GeomId geom : model.geoms_of(link_id(body, link))) {
        if (model.geoms()[geom.index()].role != GeomRole::kVisual) continue;
        guise.rgba[geom.index()] = memory.rgba[k];
        if (memory.textures[k] >= 0) {
          guise.textures.resize(guise.rgba.size());
          const auto texture = textures_.find(memory.textures[k]);
          if (texture != textures_.end()) guise.textures[geom.index()].image = texture->second;
        }
        ++k;
      }
    }
  }
  return guise;
}

void Client::take_picture(const PictureRequest& request, const PictureResult& result, const ImageReader& read) {
  locate_all();
  const std::shared_ptr<const Model> model = world_.shared_model();
  const std::span<const double> q = world_.q(), mocap = world_.mocap();
  Shot shot{.camera = camera_of(request), .q = {q.begin(), q.end()}, .mocap = {mocap.begin(), mocap.end()}};
  shot.guise = guise_of(*model);
  shot.look.shadows = request.shadow;
  if (request.light && norm(*request.light) > 0) shot.look.light = *request.light;
  const std::size_t pixels = static_cast<std::size_t>(request.width) * static_cast<std::size_t>(request.height);
  std::vector<std::uint8_t> colour(3 * pixels);
  const std::span<std::int32_t> links = request.segmentation ? result.segmentation : std::span<std::int32_t>{};
  renderer_of(model, read)->render(std::span(&shot, 1), {colour, result.depth, links, {}});
  for (std::size_t i = 0; i < pixels; ++i) {
    std::copy_n(&colour[3 * i], 3, &result.rgba[4 * i]);
    result.rgba[4 * i + 3] = 255;
    result.depth[i] = buffer_depth(shot.camera, result.depth[i]);
  }
  for (std::int32_t& link : links) {
    if (link < 0) continue;
    const auto [body, number] = owners_[static_cast<std::size_t>(link)];
    link = body < 0 ? -1 : request.links_too ? body + ((number + 1) << 24) : body;
  }
}

}  // namespace manyhands::bullet
