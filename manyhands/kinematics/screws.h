// A model seen as screws: joint axes at one configuration, and poses as products of exponentials (Lynch and Park,
// Modern Robotics, 2017, chapter 4).
#pragma once

#include <span>
#include <vector>

#include "manyhands/math/rigid_motion.h"
#include "manyhands/model/model.h"
#include "manyhands/physics/dynamics/jacobian_form.h"

namespace manyhands {

/// The screw axes S of all dofs, and where a frame is, at a home configuration q0.
struct ScrewAxes {
  JacobianForm form = JacobianForm::kSpace;                ///< or kBody
  Transform<double> home = Transform<double>::identity();  ///< X_WF at q0
  std::vector<Motion<double>> axes{};                      ///< (nv), zero for dofs that do not move the frame
  std::vector<int> joint{};                                ///< (nv) whose axis: those of one joint share a factor
};

/// The columns of the frame's Jacobian at `q0` (nq), of the form kSpace or kBody.
/// Throws std::invalid_argument if q0 has not nq numbers, or for another form.
[[nodiscard]] ScrewAxes screw_axes(const Model& model, FrameId frame, std::span<const double> q0,
                                   JacobianForm form = JacobianForm::kSpace);

/// How far each screw turns from `q0` (nq) to `q` (nq): theta (nv). It is q - q0 for joints of one degree of freedom,
/// and the logarithm of the joint's displacement for the others.
/// Throws std::invalid_argument if one has not nq numbers.
[[nodiscard]] std::vector<double> screw_coordinates(const Model& model, std::span<const double> q0,
                                                    std::span<const double> q);

/// X_WF where the screws have turned by `theta` (nv): the product over joints, root first, of
/// exp6(sum of S theta over the joint's axes), then home; in the body form home comes first.
/// Throws std::invalid_argument if theta has not one number for each axis.
[[nodiscard]] Transform<double> product_of_exponentials(const ScrewAxes& screws, std::span<const double> theta);

/// What screws alone say of an arm whose joints turn one after the other: no model is needed. Fast, for calls one by
/// one.
class ScrewChain {
 public:
  /// `axes` in the space form. The frame is at `home` where theta = 0.
  ScrewChain(const Transform<double>& home, std::vector<Motion<double>> axes) : home_(home), axes_(std::move(axes)) {}

  [[nodiscard]] std::size_t size() const { return axes_.size(); }
  /// exp6(S_1 theta_1) ... exp6(S_k theta_k) home, of as many screws as theta has numbers, at most all.
  /// Throws std::invalid_argument if it has more.
  [[nodiscard]] Transform<double> pose(std::span<const double> theta) const;
  /// The columns of the space Jacobian; with `in_body` those of the body Jacobian.
  [[nodiscard]] std::vector<Motion<double>> jacobian(std::span<const double> theta, bool in_body) const;

 private:
  Transform<double> home_;
  std::vector<Motion<double>> axes_;
};

}  // namespace manyhands
