// <texture>: image files and checks, and how materials lay them on geoms.
#include <algorithm>

#include "manyhands/model/io/mjcf/mjcf_assets.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

std::array<float, 3> read_rgb(const MjcfElement& texture, const char* attribute, double grey) {
  const Vec3<double> v = texture.vec3_or(attribute, {grey, grey, grey});
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

std::optional<GeomTexture> left_out(const MjcfElement& texture, const std::string& reason) {
  texture.note(LoadAction::kIgnored, reason + "; the colour alone is shown");
  return std::nullopt;
}

std::optional<GeomTexture> read_shown(const MjcfElement& texture, const MjcfSettings& settings) {
  const std::string builtin = texture.word_or("builtin", {"none", "gradient", "checker", "flat"}, "none");
  if (builtin == "gradient") return left_out(texture, "gradients are not read");
  if (builtin != "none") {
    const std::array<float, 3> first = read_rgb(texture, "rgb1", 0.8), second = read_rgb(texture, "rgb2", 0.5);
    return GeomTexture{.rgb = {first, builtin == "checker" ? second : first}};
  }
  if (texture.text_or("file", "").empty()) return left_out(texture, "it has neither 'builtin' nor 'file'");
  const std::string path = path_in(settings.texture_folder, texture.text("file"), settings);
  try {
    return GeomTexture{.file = texture.paths().resolve(path).string()};
  } catch (const std::runtime_error& error) {
    return left_out(texture, error.what());
  }
}

}  // namespace

MjcfTexture read_texture(const MjcfElement& texture, const MjcfSettings& settings) {
  const std::string type = texture.word_or("type", {"2d", "cube", "skybox"}, "cube");
  if (type == "skybox") {
    texture.note_once("skybox", LoadAction::kIgnored, "pictures have a sky of their own; the skybox is not shown");
    return {};
  }
  texture.expect(
      {"name", "type", "builtin", "rgb1", "rgb2", "file", "content_type", "colorspace", "width", "height", "nchannel"});
  return {.shown = read_shown(texture, settings), .is_cube = type == "cube"};
}

std::optional<GeomTexture> texture_on(ShapeType shape, const MjcfMaterial& material, const MjcfElement& geom) {
  std::optional<GeomTexture> texture = material.texture;
  if (!texture || shape != ShapeType::kPlane) return texture;
  // MuJoCo's unit of length for textures is 2 m, the width of a plane of size 1 (settexture in its render_gl3.c).
  const std::vector<double> size = geom.has("size") ? geom.numbers("size", 1, 3) : std::vector<double>{};
  for (std::size_t i = 0; i < 2; ++i) {
    const bool is_along_plane = !material.is_uniform && i < size.size() && size[i] > 0;
    const double repeat = 0.5 * static_cast<double>(texture->repeat[i]) / (is_along_plane ? size[i] : 1);
    texture->repeat[i] = static_cast<float>(std::clamp<double>(repeat, 1 / kMostRepeats, kMostRepeats));
  }
  return texture;
}

}  // namespace manyhands::io
