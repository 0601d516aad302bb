// The frames of an SDF world: which is given relative to which, and which moves with which link.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "manyhands/model/io/sdf/sdf_element.h"

namespace manyhands::io {

/// A frame, and what its names mean: those in `scope`, such as "robot::arm::".
struct SdfFrame {
  SdfElement source;
  std::string scope{};
  SdfPose pose{};
  std::string base{};            ///< key of the frame that the pose is relative to unless it says another
  std::string placement{};       ///< of a model: the name of the frame in it that the pose is of; empty: its own
  std::string attached_to{};     ///< the name of the frame that it moves with; empty where it is a link
  std::string attached_scope{};  ///< where that name is looked up
};

/// Keys are names with their scope: "robot::hand", of models "robot::__model__". The empty key is the world.
class SdfFrames {
 public:
  /// Fails if the key is taken.
  void add(const std::string& key, SdfFrame frame);
  [[nodiscard]] SdfFrame& at(const std::string& key) { return frames_.at(key); }

  /// The key of what `name` means in the scope. Fails, at `source`, if there is none.
  [[nodiscard]] std::string find(const SdfElement& source, const std::string& scope, const std::string& name) const;
  /// The same; "world" and what no scope has is the world.
  [[nodiscard]] bool is_world(const std::string& scope, const std::string& name) const;

  /// The pose X_WF. Fails on frames that are relative to each other in a circle.
  [[nodiscard]] Transform<double> pose(const std::string& key) const;
  /// The key of the link that the frame moves with; empty: the world.
  [[nodiscard]] std::string link_of(const std::string& key) const;

 private:
  [[nodiscard]] std::string base_of(const SdfFrame& frame) const;
  /// The frame in its base.
  [[nodiscard]] Transform<double> local(const std::string& key, const SdfFrame& frame, int depth) const;
  [[nodiscard]] Transform<double> pose_in(const std::string& model, const std::string& key, int depth) const;

  std::map<std::string, SdfFrame> frames_;
  mutable std::map<std::string, Transform<double>> found_;
};

}  // namespace manyhands::io
