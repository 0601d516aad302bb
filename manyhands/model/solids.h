// The mass that shapes have, of solids and skins.
#pragma once

#include "manyhands/model/description.h"

namespace manyhands {

/// Mass properties of a solid shape of density 1 about its own frame: sphere, capsule, cylinder, box; 0 for others.
[[nodiscard]] Inertial solid_of(const Shape& shape);
/// Of the ellipsoid with these half axes.
[[nodiscard]] Inertial solid_ellipsoid(const Vec3<double>& half_axes);
/// The same of their skins, at 1 kg/m^2.
[[nodiscard]] Inertial skin_of(const Shape& shape);
/// Of the skin of an ellipsoid, as MuJoCo approximates it: the area by Thomsen's formula (to 1.1 %), the inertia that
/// of the layer between it and the ellipsoid with slightly longer axes.
[[nodiscard]] Inertial skin_of_ellipsoid(const Vec3<double>& half_axes);
/// Where a file puts the vertices of a mesh: p -> A p + b. Volumes of small parts far from the origin need it in
/// double, before vertices are rounded to float.
struct AffineMap {
  Mat3<double> A = Mat3<double>::identity();
  Vec3<double> b = Vec3<double>::zero();

  [[nodiscard]] Vec3<double> operator*(const Vec3<double>& p) const { return A * p + b; }
  [[nodiscard]] bool mirrors() const { return dot(A.x, cross(A.y, A.z)) < 0; }
};

/// Of the solid inside a mesh once it is placed (Eberly, Polyhedral Mass Properties, 2002, by pyramids on each face).
/// `legacy` counts every pyramid as positive, as MuJoCo does unless told otherwise: from the middle of the faces for
/// the centre of mass, from there for mass and inertia.
[[nodiscard]] Inertial solid_of(const Mesh& mesh, bool legacy, const AffineMap& place = {});
/// Of its skin, at 1 kg/m^2.
[[nodiscard]] Inertial skin_of(const Mesh& mesh, const AffineMap& place = {});

/// All masses and inertias times `factor`.
[[nodiscard]] Inertial scaled(const Inertial& inertial, double factor);
/// The inertial of a part at pose X, in the frame in which X is given.
[[nodiscard]] Inertial placed(const Transform<double>& X, const Inertial& inertial);
/// Both together.
[[nodiscard]] Inertial sum(const Inertial& a, const Inertial& b);

}  // namespace manyhands
