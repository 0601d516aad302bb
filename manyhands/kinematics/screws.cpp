#include "manyhands/kinematics/screws.h"

#include <stdexcept>
#include <string>

#include "manyhands/base/index.h"
#include "manyhands/physics/dynamics/jacobians.h"

namespace manyhands {

namespace {

void require_length(const char* name, std::span<const double> numbers, std::size_t expected) {
  if (numbers.size() == expected) return;
  throw std::invalid_argument(std::string(name) + " has " + std::to_string(numbers.size()) + " numbers; expected " +
                              std::to_string(expected));
}

Mat3<double> rotation_at(std::span<const double> q, int first) {
  const std::size_t i = index(first);
  return to_matrix(normalized(Quat<double>{q[i], q[i + 1], q[i + 2], q[i + 3]}));
}

Vec3<double> point_at(std::span<const double> q, int first) {
  const std::size_t i = index(first);
  return {q[i], q[i + 1], q[i + 2]};
}

/// The displacement of a free body from q0 to q as a twist about where its origin was, in the axes of the joint.
Motion<double> displacement(const Mat3<double>& R0, const Vec3<double>& p0, const Mat3<double>& R,
                            const Vec3<double>& p) {
  return log6(Transform<double>{R * transpose(R0), p - p0});
}

}  // namespace

ScrewAxes screw_axes(const Model& model, FrameId frame, std::span<const double> q0, JacobianForm form) {
  require_length("q0", q0, index(model.nq()));
  if (form == JacobianForm::kMixed) throw std::invalid_argument("screw axes have the form 'space' or 'body'");
  const Tree<double> tree(model);
  Workspace<double> ws(tree);
  forward_kinematics(tree, q0.data(), ws);
  const Frame& f = model.frame(frame);
  ScrewAxes found{form, frame_pose(f.body, f.X_BF, ws)};
  found.axes.assign(index(model.nv()), Motion<double>::zero());
  found.joint.assign(model.dof_joint().begin(), model.dof_joint().end());
  visit_jacobian(tree, form, f.body, f.X_BF, ws, [&](int dof, const Motion<double>& S) { found.axes[index(dof)] = S; });
  return found;
}

std::vector<double> screw_coordinates(const Model& model, std::span<const double> q0, std::span<const double> q) {
  require_length("q0", q0, index(model.nq()));
  require_length("q", q, index(model.nq()));
  std::vector<double> theta(index(model.nv()));
  for (const Body& body : model.bodies()) {
    double* const to = theta.data() + body.iv;
    const auto take = [&](std::size_t at, const Vec3<double>& v) { to[at] = v.x, to[at + 1] = v.y, to[at + 2] = v.z; };
    switch (body.type) {
      case JointType::kFixed:
      case JointType::kMocap:
        break;
      case JointType::kRevolute:
      case JointType::kContinuous:
      case JointType::kPrismatic:
        *to = q[index(body.iq)] - q0[index(body.iq)];
        break;
      case JointType::kSpherical:
        take(0, rotation_vector(to_quat(rotation_at(q, body.iq) * transpose(rotation_at(q0, body.iq)))));
        break;
      case JointType::kPlanar: {
        const std::size_t i = index(body.iq);
        const Quat<double> turn = quat_from_rotation_vector(Vec3<double>{0, 0, q[i + 2] - q0[i + 2]});
        const Motion<double> d =
            displacement(Mat3<double>::identity(), {q0[i], q0[i + 1], 0}, to_matrix(turn), {q[i], q[i + 1], 0});
        take(0, {d.v.x, d.v.y, d.w.z});
        break;
      }
      case JointType::kFloating: {
        const Motion<double> d = displacement(rotation_at(q0, body.iq + 3), point_at(q0, body.iq),
                                              rotation_at(q, body.iq + 3), point_at(q, body.iq));
        take(0, d.w);
        take(3, d.v);
        break;
      }
    }
  }
  return theta;
}

Transform<double> product_of_exponentials(const ScrewAxes& screws, std::span<const double> theta) {
  require_length("theta", theta, screws.axes.size());
  Transform<double> X = screws.form == JacobianForm::kBody ? screws.home : Transform<double>::identity();
  for (std::size_t k = 0; k < theta.size();) {
    Motion<double> twist = Motion<double>::zero();
    const int joint = screws.joint[k];
    for (; k < theta.size() && screws.joint[k] == joint; ++k) twist = fma(theta[k], screws.axes[k], twist);
    X = X * exp6(twist);
  }
  return screws.form == JacobianForm::kBody ? X : X * screws.home;
}

Transform<double> ScrewChain::pose(std::span<const double> theta) const {
  if (theta.size() > axes_.size()) require_length("theta", theta, axes_.size());
  Transform<double> X = Transform<double>::identity();
  for (std::size_t k = 0; k < theta.size(); ++k) X = X * exp6(theta[k] * axes_[k]);
  return X * home_;
}

std::vector<Motion<double>> ScrewChain::jacobian(std::span<const double> theta, bool in_body) const {
  if (theta.size() > axes_.size()) require_length("theta", theta, axes_.size());
  Transform<double> X = Transform<double>::identity();
  std::vector<Motion<double>> columns;
  for (std::size_t k = 0; k < theta.size(); ++k) {
    columns.push_back(transformed(X, axes_[k]));
    X = X * exp6(theta[k] * axes_[k]);
  }
  if (!in_body) return columns;
  const Transform<double> X_FW = inverse(X * home_);
  for (Motion<double>& column : columns) column = transformed(X_FW, column);
  return columns;
}

}  // namespace manyhands
