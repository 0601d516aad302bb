#include "manyhands/model/io/mjcf/mjcf_inertia.h"

#include <Eigen/Core>

namespace manyhands::io {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A dof about the world's origin in world axes, angular first. In these common coordinates nothing is transformed.
struct Dof {
  std::size_t joint{};
  int inner = -1;                     ///< the dof that moves what it moves against; -1 for the world
  Vector6 S = Vector6::Zero();        ///< its motion
  Matrix6 I_A = Matrix6::Zero();      ///< what it moves, as articulated
  Vector6 K = Vector6::Zero();        ///< the force on its inner dof when it is pushed by 1
  double D_inverse{};                 ///< its acceleration when it is pushed by 1 and its inner dof holds
  Matrix6 Omega_B = Matrix6::Zero();  ///< acceleration of what it moves by a force on that
};

Vector6 motion(const Vec3<double>& w, const Vec3<double>& v) { return {w.x, w.y, w.z, v.x, v.y, v.z}; }

/// The motion of a joint's k-th dof.
Vector6 axis_of(const MjcfJoint& joint, JointType type, int k) {
  constexpr std::array<Vec3<double>, 3> kUnits{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (type == JointType::kPrismatic) return motion({}, joint.axis_W);
  if (k >= 3) return motion({}, kUnits[static_cast<std::size_t>(k - 3)]);
  const Vec3<double> axis = velocity_size(type) == 1 ? joint.axis_W : kUnits[static_cast<std::size_t>(k)];
  return motion(axis, cross(joint.anchor_W, axis));
}

Matrix6 inertia_of(const MjcfScene& scene, const MjcfBody& body) {
  const RigidInertia<double> I =
      transformed(body.X_WB, scene.builder.links()[body.link.index()].inertial.about_origin());
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>() << I.I.xx, I.I.xy, I.I.xz, I.I.xy, I.I.yy, I.I.yz, I.I.xz, I.I.yz, I.I.zz;
  result.topRightCorner<3, 3>() << 0, -I.h.z, I.h.y, I.h.z, 0, -I.h.x, -I.h.y, I.h.x, 0;
  result.bottomLeftCorner<3, 3>() = result.topRightCorner<3, 3>().transpose();
  result.bottomRightCorner<3, 3>().diagonal().setConstant(I.m);
  return result;
}

/// The dofs of the scene, inner ones first, with the inertias of the bodies that they move.
std::vector<Dof> dofs_of(const MjcfScene& scene) {
  std::vector<Dof> dofs;
  std::vector<int> last(scene.bodies.size(), -1);  // that moves the body
  std::size_t joint = 0;
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    last[b] = last[static_cast<std::size_t>(scene.bodies[b].parent)];
    for (; joint < scene.joints.size() && scene.joints[joint].body == static_cast<int>(b); ++joint) {
      const MjcfJoint& of_file = scene.joints[joint];
      const JointType type = scene.builder.joints()[of_file.id.index()].type;
      for (int k = 0; k < velocity_size(type); ++k) {
        dofs.push_back({.joint = joint, .inner = last[b], .S = axis_of(of_file, type, k)});
        last[b] = static_cast<int>(dofs.size()) - 1;
      }
    }
    if (last[b] >= 0) dofs[static_cast<std::size_t>(last[b])].I_A += inertia_of(scene, scene.bodies[b]);
  }
  return dofs;
}

}  // namespace

std::vector<double> yielding_inertias(const MjcfScene& scene) {
  constexpr double kLeast = 1e-15;  // MuJoCo's mjMINVAL
  std::vector<Dof> dofs = dofs_of(scene);
  for (std::size_t i = dofs.size(); i-- > 0;) {
    Dof& dof = dofs[i];
    const Vector6 U = dof.I_A * dof.S;
    const double armature = scene.builder.joints()[scene.joints[dof.joint].id.index()].armature;
    dof.D_inverse = 1 / std::max(kLeast, dof.S.dot(U) + armature);
    dof.K = dof.D_inverse * U;
    if (dof.inner >= 0) dofs[static_cast<std::size_t>(dof.inner)].I_A += dof.I_A - dof.K * U.transpose();
  }
  std::vector<double> mobility(scene.joints.size(), 0.0), count(scene.joints.size(), 0.0);
  for (Dof& dof : dofs) {
    const Matrix6 inner = dof.inner < 0 ? Matrix6::Zero() : dofs[static_cast<std::size_t>(dof.inner)].Omega_B;
    mobility[dof.joint] += dof.D_inverse + dof.K.dot(inner * dof.K);
    count[dof.joint] += 1;
    const Matrix6 held = Matrix6::Identity() - dof.S * dof.K.transpose();
    dof.Omega_B = held * inner * held.transpose() + dof.D_inverse * dof.S * dof.S.transpose();
  }
  for (std::size_t i = 0; i < count.size(); ++i) count[i] /= std::max(kLeast, mobility[i]);
  return count;
}

}  // namespace manyhands::io
