#include "manyhands/model/io/mjcf/mjcf_inertia.h"

#include <Eigen/Cholesky>

namespace manyhands::io {

namespace {

/// The motions of a joint's dofs about the world's origin, (6, dofs): angular first.
Eigen::MatrixXd axes_of(const MjcfJoint& joint, JointType type) {
  const auto column = [](const Vec3<double>& w, const Vec3<double>& v) {
    return Eigen::Matrix<double, 6, 1>{w.x, w.y, w.z, v.x, v.y, v.z};
  };
  const std::array<Vec3<double>, 3> units{Vec3<double>{1, 0, 0}, Vec3<double>{0, 1, 0}, Vec3<double>{0, 0, 1}};
  Eigen::MatrixXd S(6, velocity_size(type));
  if (type == JointType::kPrismatic) {
    S.col(0) = column(Vec3<double>::zero(), joint.axis_W);
  } else if (S.cols() == 1) {
    S.col(0) = column(joint.axis_W, cross(joint.anchor_W, joint.axis_W));
  } else {
    for (int k = 0; k < 3; ++k) {
      const Vec3<double>& axis = units[static_cast<std::size_t>(k)];
      S.col(k) = column(axis, cross(joint.anchor_W, axis));
      if (S.cols() == 6) S.col(3 + k) = column(Vec3<double>::zero(), axis);
    }
  }
  return S;
}

/// A body's inertia about the world's origin (6, 6).
Eigen::Matrix<double, 6, 6> inertia_of(const MjcfScene& scene, const MjcfBody& body) {
  const RigidInertia<double> I =
      transformed(body.X_WB, scene.builder.links()[body.link.index()].inertial.about_origin());
  Eigen::Matrix<double, 6, 6> result = Eigen::Matrix<double, 6, 6>::Zero();
  result.topLeftCorner<3, 3>() << I.I.xx, I.I.xy, I.I.xz, I.I.xy, I.I.yy, I.I.yz, I.I.xz, I.I.yz, I.I.zz;
  result.topRightCorner<3, 3>() << 0, -I.h.z, I.h.y, I.h.z, 0, -I.h.x, -I.h.y, I.h.x, 0;
  result.bottomLeftCorner<3, 3>() = result.topRightCorner<3, 3>().transpose();
  result.bottomRightCorner<3, 3>().diagonal().setConstant(I.m);
  return result;
}

}  // namespace

std::vector<double> yielding_inertias(const MjcfScene& scene) {
  const auto described = [&](const MjcfJoint& joint) -> const Joint& {
    return scene.builder.joints()[joint.id.index()];
  };
  std::vector<Eigen::Index> first;
  Eigen::Index nv = 0;
  for (const MjcfJoint& joint : scene.joints) {
    first.push_back(nv);
    nv += velocity_size(described(joint).type);
  }
  Eigen::MatrixXd S(6, nv), M = Eigen::MatrixXd::Zero(nv, nv);
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    const Joint& joint = described(scene.joints[i]);
    const Eigen::Index n = velocity_size(joint.type);
    S.middleCols(first[i], n) = axes_of(scene.joints[i], joint.type);
    M.diagonal().segment(first[i], n).setConstant(joint.armature);
  }
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, nv);
    for (int above = static_cast<int>(b); above > 0; above = scene.bodies[static_cast<std::size_t>(above)].parent) {
      for (std::size_t i = 0; i < scene.joints.size(); ++i) {
        if (scene.joints[i].body != above) continue;
        const Eigen::Index n = velocity_size(described(scene.joints[i]).type);
        J.middleCols(first[i], n) = S.middleCols(first[i], n);
      }
    }
    M += J.transpose() * inertia_of(scene, scene.bodies[b]) * J;
  }
  const Eigen::MatrixXd inverse = M.ldlt().solve(Eigen::MatrixXd::Identity(nv, nv));
  std::vector<double> result;
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    const Eigen::Index n = velocity_size(described(scene.joints[i]).type);
    result.push_back(static_cast<double>(n) / std::max(inverse.diagonal().segment(first[i], n).sum(), 1e-15));
  }
  return result;
}

}  // namespace manyhands::io
