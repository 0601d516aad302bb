// Short ways to write an MJCF in a test and to look at what became of it.
#pragma once

#include <string>

#include "manyhands/model/io/mjcf/mjcf.h"
#include "tests/model/urdf_testing.h"

namespace manyhands::testing {

inline constexpr const char* kMjcfInertial = R"(<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>)";

inline LoadedModel load_scene(const std::string& text, const MjcfOptions& options = {}) {
  return load_mjcf_string(text, "s.xml", ".", options);
}

inline std::string mujoco(const std::string& sections) { return "<mujoco>\n" + sections + "\n</mujoco>"; }

/// A body, whose contents begin in line 3, and what follows <worldbody>.
inline std::string one_body(const std::string& contents, const std::string& sections = "") {
  return mujoco("<worldbody><body name=\"b\">\n" + contents + kMjcfInertial + "</body></worldbody>" + sections);
}

/// What the error says, or "" if there is none.
inline std::string scene_error(const std::string& text, const MjcfOptions& options = {}) {
  try {
    const LoadedModel loaded = load_scene(text, options);
  } catch (const MjcfError& error) {
    return error.what();
  }
  return "";
}

}  // namespace manyhands::testing
