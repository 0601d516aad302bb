#include "manyhands/render/camera.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace manyhands {

namespace {

using Vec = Vec3<double>;

constexpr int kMostPixels = 16384;

Camera centred(int width, int height, double focal) {
  Camera camera{.width = width, .height = height, .fx = focal, .fy = focal, .cx = 0.5 * width, .cy = 0.5 * height};
  require_camera(camera);
  return camera;
}

Vec rotated(const Vec& axis, double angle, const Vec& a) {
  const double c = std::cos(angle), s = std::sin(angle);
  return c * a + s * cross(axis, a) + ((1 - c) * dot(axis, a)) * axis;
}

/// A row of a matrix that is stored by columns.
Vec row(std::span<const double> m, std::size_t i) { return {m[i], m[i + 4], m[i + 8]}; }

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("camera: " + what); }

}  // namespace

void require_camera(const Camera& camera) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) refuse(what);
  };
  require(camera.width >= 1 && camera.height >= 1 && camera.width <= kMostPixels && camera.height <= kMostPixels,
          "the picture has " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
              " pixels; expected 1 to " + std::to_string(kMostPixels) + " each way");
  require(camera.fx > 0 && camera.fy > 0 && is_finite(camera.fx) && is_finite(camera.fy),
          "fx and fy are " + std::to_string(camera.fx) + " and " + std::to_string(camera.fy) +
              "; expected more than 0 (make cameras by perspective, intrinsics, orthographic or matrices)");
  require(is_finite(camera.cx) && is_finite(camera.cy), "cx or cy is not a finite number");
  require(camera.near >= 0 && camera.far > camera.near && is_finite(camera.far),
          "near and far are " + std::to_string(camera.near) + " m and " + std::to_string(camera.far) +
              " m; expected 0 <= near < far");
  const Transform<double>& X = camera.X_FC;
  const double sum = squared_norm(X.R.x) + squared_norm(X.R.y) + squared_norm(X.R.z) + squared_norm(X.p);
  require(is_finite(sum), "its pose is not made of finite numbers");
}

Camera perspective_camera(int width, int height, double fov_y) {
  if (!(fov_y > 0 && fov_y < std::numbers::pi)) {
    refuse("the field of view is " + std::to_string(fov_y) + " rad; expected more than 0 and less than pi");
  }
  return centred(width, height, 0.5 * height / std::tan(0.5 * fov_y));
}

Camera intrinsic_camera(int width, int height, double fx, double fy, double cx, double cy) {
  Camera camera{.width = width, .height = height, .fx = fx, .fy = fy, .cx = cx, .cy = cy};
  require_camera(camera);
  return camera;
}

Camera orthographic_camera(int width, int height, double view_height) {
  if (!(view_height > 0)) refuse("it sees " + std::to_string(view_height) + " m; expected more than 0");
  Camera camera = centred(width, height, height / view_height);
  camera.orthographic = true;
  return camera;
}

Camera camera_from_matrices(int width, int height, std::span<const double> view, std::span<const double> projection) {
  if (view.size() != 16 || projection.size() != 16) {
    refuse("the matrices have " + std::to_string(view.size()) + " and " + std::to_string(projection.size()) +
           " numbers; expected 16 each");
  }
  const Vec right = row(view, 0), up = row(view, 1), back = row(view, 2), shift{view[12], view[13], view[14]};
  constexpr double kClose = 1e-3;  // matrices are often single precision
  const bool rigid = abs(norm(right) - 1) < kClose && abs(norm(up) - 1) < kClose &&
                     norm(cross(right, up) - back) < kClose && abs(view[15] - 1) < kClose;
  if (!rigid) refuse("the view matrix is no rigid pose in OpenGL's order, column by column");

  const std::span<const double>& P = projection;
  const bool parallel = P[11] == 0 && P[15] == 1, central = P[11] == -1 && P[15] == 0;
  for (const std::size_t i : {1U, 2U, 3U, 4U, 6U, 7U}) {
    if (P[i] != 0 || !(parallel || central)) refuse("the projection matrix is neither perspective nor parallel");
  }
  Camera camera{.width = width, .height = height, .orthographic = parallel};
  camera.fx = 0.5 * width * P[0];
  camera.fy = 0.5 * height * P[5];
  // x_ndc = P0 x/(-z) - P8 for a perspective, P0 x + P12 for a parallel one.
  camera.cx = 0.5 * width * (1 + (parallel ? P[12] : -P[8]));
  camera.cy = 0.5 * height * (1 - (parallel ? P[13] : -P[9]));
  camera.near = parallel ? (P[14] + 1) / P[10] : P[14] / (P[10] - 1);
  camera.far = parallel ? (P[14] - 1) / P[10] : P[14] / (P[10] + 1);
  const Mat3<double> R_CW = transpose(Mat3<double>{right, -up, -back});
  camera.X_FC = inverse(Transform<double>{R_CW, {shift.x, -shift.y, -shift.z}});
  require_camera(camera);
  return camera;
}

Transform<double> look_at(const Vec& eye, const Vec& target, const Vec& up) {
  const Vec view = target - eye;
  const double distance = norm(view);
  if (!(distance > 1e-9)) refuse("it stands where it looks at; move the eye or the target");
  const Vec z = (1 / distance) * view, across = cross(z, up);
  if (!(norm(across) > 1e-9 * norm(up))) refuse("`up` points along its view; choose another direction");
  const Vec x = (1 / norm(across)) * across;
  return {{x, cross(z, x), z}, eye};
}

Transform<double> orbit(const Vec& target, double distance, double yaw, double pitch, double roll) {
  // As PyBullet has it: roll about y stands between pitch about x and yaw about z, and so moves the eye as well.
  const Vec x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1};
  const auto turned = [&](const Vec& a) {
    return rotated(z_axis, yaw, rotated(y_axis, roll, rotated(x_axis, pitch, a)));
  };
  const Vec x = turned(x_axis), z = turned(y_axis);
  return {{x, cross(z, x), z}, target - distance * z};
}

std::vector<Vec3<float>> point_cloud(const Camera& camera, const Transform<double>& X_AC,
                                     std::span<const float> depth) {
  if (depth.size() != static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)) {
    refuse("the depth picture has " + std::to_string(depth.size()) + " pixels; expected " +
           std::to_string(camera.width) + " x " + std::to_string(camera.height));
  }
  std::vector<Vec3<float>> points;
  std::size_t k = 0;
  for (int j = 0; j < camera.height; ++j) {
    for (int i = 0; i < camera.width; ++i) {
      const double z = static_cast<double>(depth[k++]);
      if (z >= static_cast<double>(static_cast<float>(camera.far))) continue;
      const double scale = camera.orthographic ? 1 : z;
      const Vec p_C{scale * (i + 0.5 - camera.cx) / camera.fx, scale * (j + 0.5 - camera.cy) / camera.fy, z};
      points.push_back(broadcast<float>(X_AC * p_C));
    }
  }
  return points;
}

}  // namespace manyhands
