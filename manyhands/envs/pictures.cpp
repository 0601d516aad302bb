#include "manyhands/envs/pictures.h"

#include <algorithm>

#include "manyhands/base/hash.h"
#include "manyhands/math/quaternion.h"

namespace manyhands {

namespace {

constexpr std::size_t kRotation = 4;      // numbers of a goal that is an orientation
constexpr double kGoalRadius = 0.02;      // of the ball that shows where the hand is to come [m]
constexpr double kRotationHeight = 0.06;  // where orientations are shown, in the middle of the table [m]
constexpr float kGoalAlpha = 0.5f;

/// The world itself, and links that hang on it and carry nothing.
bool is_thing(const Model& model, LinkId link) {
  const auto carries = [&](const Link& other) { return other.parent == link; };
  return link == LinkId(0) || (model.link(link).parent == LinkId(0) && std::ranges::none_of(model.links(), carries));
}

}  // namespace

EnvPictures::EnvPictures(const EnvBatch& envs, int num_threads) : EnvPictures(envs, envs.scene(), num_threads) {}

EnvPictures::EnvPictures(const EnvBatch& envs, EnvScene scene, int num_threads)
    : envs_(envs),
      objects_(std::move(scene.objects)),
      renderer_(std::make_shared<const Model>(std::move(scene.model)), num_threads) {
  const std::span<const Geom> geoms = model().geoms();
  for (const Geom& geom : geoms) {
    patterns_.push_back(usual_pattern(geom));
    takes_texture_.push_back(is_thing(model(), geom.link));
  }
  // Where a rotation is the goal, one must see how things are turned.
  if (static_cast<std::size_t>(envs.spec().goal_dim) != kRotation) return;
  for (const GeomId object : objects_) {
    patterns_[object.index()] = Pattern::kDie;
    takes_texture_[object.index()] = false;
  }
}

SeenWorld EnvPictures::view(int world) const {
  SeenWorld view;
  view.q.resize(static_cast<std::size_t>(model().nq()));
  view.sizes.resize(objects_.size());
  envs_.see(world, view.q, view.sizes);
  const auto columns = static_cast<std::size_t>(envs_.spec().goal_dim);
  const auto goal = envs_.desired_goal().subspan(static_cast<std::size_t>(world) * columns, columns);
  view.goal.assign(goal.begin(), goal.end());
  return view;
}

Shot EnvPictures::shot(const SeenWorld& view, const Camera& camera, const Look& look, const PictureVariation& variation,
                       std::uint32_t camera_number) const {
  Shot shot{.camera = camera, .look = look, .q = view.q};
  shot.guise.patterns = patterns_;
  shot.guise.sizes.resize(patterns_.size(), Vec3<double>::zero());
  for (std::size_t k = 0; k < objects_.size(); ++k) shot.guise.sizes[objects_[k].index()] = view.sizes[k];
  shot.marks = goal_marks(view.goal, view.sizes);
  if (variation != PictureVariation{}) {
    Hash hash;
    for (const float number : view.goal) hash.add(number);
    vary(shot, variation, RandomStream(hash.value(), camera_number, 0));
  }
  return shot;
}

void EnvPictures::vary(Shot& shot, const PictureVariation& variation, RandomStream random) const {
  const auto off = [&](double most) { return random.uniform(-most, most); };
  const auto vector = [&](double most) {
    const double x = off(most), y = off(most), z = off(most);
    return Vec3<double>{x, y, z};
  };
  const Vec3<double> moved = vector(variation.position);
  const Mat3<double> turned = to_matrix(quat_from_rotation_vector(vector(variation.direction)));
  shot.camera.X_FC = shot.camera.X_FC * Transform<double>{turned, moved};
  const double zoom = 1 + off(variation.zoom);
  shot.camera.fx *= zoom;
  shot.camera.fy *= zoom;
  shot.look.light = (1 / norm(shot.look.light)) * shot.look.light + vector(variation.light);
  shot.look.sun *= static_cast<float>(1 + off(variation.brightness));
  shot.look.ambient *= static_cast<float>(1 + off(variation.brightness));
  if (variation.colour > 0) vary_colours(shot, variation.colour, random);
  if (variation.texture > 0) vary_textures(shot, variation, random);
}

void EnvPictures::vary_colours(Shot& shot, double most, RandomStream& random) const {
  for (const Geom& geom : model().geoms()) {
    std::array<float, 4>& rgba = shot.guise.rgba.emplace_back(geom.rgba);
    for (std::size_t c = 0; c < 3; ++c) {
      rgba[c] = clamp(rgba[c] + static_cast<float>(random.uniform(-most, most)), 0.0f, 1.0f);
    }
  }
}

void EnvPictures::vary_textures(Shot& shot, const PictureVariation& variation, RandomStream& random) const {
  const std::span<const Geom> geoms = model().geoms();
  const bool is_tinted = !shot.guise.rgba.empty();
  shot.guise.textures.resize(geoms.size());
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    if (!is_tinted) shot.guise.rgba.push_back(geoms[i].rgba);
    // As many numbers for each geom, whether it wears a texture or not.
    const bool is_worn = random.unit<double>() < variation.texture;
    const double which = random.unit<double>();
    const auto repeat = static_cast<float>(random.uniform(0.5, 4.0));
    if (!is_worn || !takes_texture_[i]) continue;
    const auto one_of = [&](const auto& all) {
      return all[static_cast<std::size_t>(which * static_cast<double>(all.size()))];
    };
    shot.guise.textures[i] =
        variation.textures.empty() ? Texture{one_of(assorted_images()), {repeat, repeat}} : one_of(variation.textures);
    for (std::size_t c = 0; c < 3; ++c) {
      const float tint = is_tinted ? shot.guise.rgba[i][c] - geoms[i].rgba[c] : 0;
      shot.guise.rgba[i][c] = clamp(1 + tint, 0.0f, 1.0f);  // the image's own colours
    }
  }
}

std::vector<Mark> EnvPictures::goal_marks(std::span<const float> goal, std::span<const Vec3<double>> sizes) const {
  const auto number = [&](std::size_t i) { return static_cast<double>(goal[i]); };
  if (objects_.empty()) {
    Mark ball{.shape = {.type = ShapeType::kSphere, .size = {kGoalRadius, 0, 0}}};
    ball.rgba[3] = kGoalAlpha;
    ball.X_WM.p = {number(0), number(1), number(2)};
    return {ball};
  }
  std::vector<Mark> marks;
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    const Geom& geom = model().geoms()[objects_[k].index()];
    Mark mark{.shape = {.type = geom.shape.type, .size = sizes[k]}, .rgba = geom.rgba};
    mark.rgba[3] = kGoalAlpha;
    mark.pattern = patterns_[objects_[k].index()];
    Transform<double> X_WO = Transform<double>::identity();
    if (goal.size() == kRotation) {
      X_WO = {to_matrix(normalized(Quat<double>{number(0), number(1), number(2), number(3)})), {0, 0, kRotationHeight}};
    } else {
      X_WO.p = {number(3 * k), number(3 * k + 1), number(3 * k + 2)};
    }
    mark.X_WM = X_WO * geom.X_LG;
    marks.push_back(mark);
  }
  return marks;
}

}  // namespace manyhands
