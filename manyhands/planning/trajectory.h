// A motion as a value: numbers that follow time by polynomials, piece after piece.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace manyhands {

/// n numbers as functions of time [0, duration]: piece k lasts from breaks[k] to breaks[k + 1] and is the polynomial
/// sum of c_j (t - breaks[k])^j. Splines, trapezoids and what the time parametrisation makes of them are all of this
/// kind, exactly. Before and after, it stands still at its ends.
class Trajectory {
 public:
  /// breaks: (m + 1) [s], rising from 0. coefficients: (m, order, width), the lowest power first. Throws
  /// std::invalid_argument on other lengths, on breaks that do not rise, and on numbers that are not finite.
  Trajectory(std::vector<double> breaks, std::vector<double> coefficients, std::size_t width);

  [[nodiscard]] double duration() const { return breaks_.back(); }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t pieces() const { return breaks_.size() - 1; }
  [[nodiscard]] std::size_t order() const { return coefficients_.size() / (pieces() * width_); }
  [[nodiscard]] std::span<const double> breaks() const { return breaks_; }
  [[nodiscard]] std::span<const double> coefficients() const { return coefficients_; }
  /// (order, width) of one piece.
  [[nodiscard]] std::span<const double> piece(std::size_t k) const;
  /// The piece in whose time t lies: the later one at a break, the first or the last outside of [0, duration].
  [[nodiscard]] std::size_t piece_at(double t) const;

  /// (order, width) of one piece, as powers of the time since `since` [s] after its beginning.
  [[nodiscard]] std::vector<double> piece_from(std::size_t k, double since) const;
  /// What it does from one time to another, as a trajectory that begins at 0; it stands still where this one does.
  /// Throws std::invalid_argument unless `to` is later than `from`.
  [[nodiscard]] Trajectory part(double from, double to) const;

  /// q, v and a (width) of one piece, `since` [s] after its beginning.
  void sample_piece(std::size_t k, double since, double* q, double* v, double* a) const;
  /// Position, velocity and acceleration, (n, width) each, at n times in any order.
  void sample(std::span<const double> t, std::span<double> q, std::span<double> v, std::span<double> a) const;

 private:
  std::size_t width_;
  std::vector<double> breaks_, coefficients_;
};

/// One after the other, in time. Where one ends the next begins, or positions jump. Throws std::invalid_argument if
/// there are none, or of different widths.
[[nodiscard]] Trajectory joined(std::span<const Trajectory> motions);

}  // namespace manyhands
