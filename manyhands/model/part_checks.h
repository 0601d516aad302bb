// What must hold of parts before they can belong to a model.
#pragma once

#include "manyhands/model/model.h"

namespace manyhands {

[[nodiscard]] inline bool finite(double a) { return is_finite(a); }
[[nodiscard]] inline bool finite(const Vec3<double>& a) { return finite(a.x) && finite(a.y) && finite(a.z); }

/// How many numbers of Shape::size a shape uses.
[[nodiscard]] std::size_t num_sizes(ShapeType type);

/// Throws ModelError, naming the part, on numbers that are not finite, a negative mass, or an inertia that is not
/// positive semi-definite.
void check_inertial(const std::string& link, const Inertial& inertial);

/// Throws ModelError on a size that is not above 0, a pose that is not finite, what `check_surface` refuses, or a
/// texture that is not repeated more than 0 times.
void check_geom(const Geom& geom);

/// Throws ModelError, naming the part, on numbers that are negative or not finite, a restitution above 1, or a surface
/// with both a stiffness and a compliance.
void check_surface(const std::string& what, const SurfaceMaterial& surface);

/// Throws ModelError, naming the part, on a restitution that is not between 0 and 1.
void check_restitution(const std::string& what, double restitution);

/// Throws ModelError, naming the part, on numbers that are no compliance. None is one.
void check_compliance(const std::string& what, const std::optional<Compliance>& compliance);

/// Throws ModelError unless it is either fixed, with coefficients other than 0, or spatial, with two points or more and
/// a divisor above 0 in each branch, and on numbers that are negative, not finite, or limits out of order.
void check_tendon(const Tendon& tendon);

/// Throws ModelError on vertices that are not finite and triangles of vertices that do not exist.
void check_mesh(const Mesh& mesh);

/// Throws ModelError unless the grid has 2 x 2 finite heights or more and spacings above 0.
void check_height_field(const HeightField& field);

}  // namespace manyhands
