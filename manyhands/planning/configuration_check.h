// Whether configurations and whole motions of a scene are free of collision.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "manyhands/planning/path_constraints.h"

namespace manyhands {

/// Two links nearer to each other than they may be.
struct Encounter {
  std::string a{}, b{};  ///< links; "cloud 0" is a cloud
  double distance{};     ///< [m]; of clouds an upper bound
};

/// Balls in lanes decide nearly always, exact distances the rest. Scratch of one thread.
class ConfigurationCheck {
 public:
  /// Of a scene. With constraints, ways that do not keep them are not free either; single configurations are.
  explicit ConfigurationCheck(const PlanningScene& scene, std::optional<PathConstraints> keep = {});
  ~ConfigurationCheck();
  ConfigurationCheck(ConfigurationCheck&&) noexcept;

  /// Whether nothing collides anywhere on the way, not only where it is looked at. Each look has lanes spread over the
  /// motion; each lane answers for the part of the way around it, along which no point moves by more than a sway that
  /// follows from the links' lengths. What cannot be decided is halved. Ways that pass within half a millimetre of an
  /// obstacle may be refused.
  [[nodiscard]] bool is_free(const MotionPiece& motion);
  /// The same along the straight line from a to b (n).
  [[nodiscard]] bool is_free(std::span<const float> a, std::span<const float> b);

  [[nodiscard]] PathConstraints* constraints();  ///< null without

  /// Which of the configurations, rows of n, are free: exactly.
  [[nodiscard]] std::vector<std::uint8_t> are_free(std::span<const double> rows);
  /// What collides there: the deepest. By exact distances of shapes alone, without balls or lanes; none if it is free.
  [[nodiscard]] std::optional<Encounter> encounter(std::span<const double> planned);
  /// The least distance of any two things that may not touch [m], whatever the margin; the same way. Infinite if there
  /// are no two.
  [[nodiscard]] Encounter nearest(std::span<const double> planned);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace manyhands
