// Where pictures are taken from.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "manyhands/model/model.h"

namespace manyhands {

/// A camera without distortion. Its frame C is the optical one: x to the right, y down, z forward. Pixel (i, j) is that
/// of column i and row j from the top left; its centre is at (i + 0.5, j + 0.5).
struct Camera {
  int width = 640, height = 480;                           ///< [pixels]
  double fx = 0, fy = 0;                                   ///< [pixels per unit of x/z]; orthographic: [pixels/m]
  double cx = 0, cy = 0;                                   ///< where the optical axis meets the picture [pixels]
  bool orthographic = false;                               ///< rays are parallel to z
  double near = 0.01, far = 100;                           ///< what is seen lies between these depths [m]
  std::string frame{};                                     ///< F: a frame or link of the model; "": the world
  Transform<double> X_FC = Transform<double>::identity();  ///< pose in F
};

/// A camera that sees `fov_y` [rad] from the top to the bottom, at the world's origin. Throws std::invalid_argument
/// unless 0 < fov_y < pi and 1 <= width, height <= 16384.
[[nodiscard]] Camera perspective_camera(int width, int height, double fov_y);
/// A camera by its intrinsics [pixels]. Throws std::invalid_argument unless fx and fy are above 0.
[[nodiscard]] Camera intrinsic_camera(int width, int height, double fx, double fy, double cx, double cy);
/// A camera with parallel rays that sees `view_height` [m] from the top to the bottom.
[[nodiscard]] Camera orthographic_camera(int width, int height, double view_height);
/// A camera in the world from OpenGL's matrices, column by column, as PyBullet's computeViewMatrix and
/// computeProjectionMatrix give them. Throws std::invalid_argument if they are none of a rigid pose, and of a
/// perspective or parallel projection without shear.
[[nodiscard]] Camera camera_from_matrices(int width, int height, std::span<const double> view,
                                          std::span<const double> projection);

/// The pose of a camera at `eye` that looks at `target`; `up` points to the upper edge of the picture. Throws
/// std::invalid_argument if eye and target coincide, or `up` points along the view.
[[nodiscard]] Transform<double> look_at(const Vec3<double>& eye, const Vec3<double>& target,
                                        const Vec3<double>& up = {0, 0, 1});
/// The pose of a camera `distance` [m] from `target`, as PyBullet's computeViewMatrixFromYawPitchRoll with z up. Angles
/// in radians: at yaw 0 it looks along y, a positive yaw takes the camera round counter-clockwise seen from above, and
/// a negative pitch lets it look down.
[[nodiscard]] Transform<double> orbit(const Vec3<double>& target, double distance, double yaw, double pitch,
                                      double roll = 0);

/// The points that a depth picture (height, width) [m] of the camera shows: (k, 3) in the axes of the frame A for
/// X_AC. Pixels at the far plane are left out.
[[nodiscard]] std::vector<Vec3<float>> point_cloud(const Camera& camera, const Transform<double>& X_AC,
                                                   std::span<const float> depth);

/// Throws std::invalid_argument unless sizes, lengths and depths are such as a picture can be taken with.
void require_camera(const Camera& camera);

}  // namespace manyhands
