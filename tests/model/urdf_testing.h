// Short ways to write a URDF in a test and to look at what became of it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "manyhands/model/io/urdf/urdf.h"

namespace manyhands::testing {

inline constexpr std::string_view kInertial =
    "<inertial><mass value=\"1\"/>"
    "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";

inline std::string robot(const std::string& body) { return "<robot name=\"r\">\n" + body + "\n</robot>"; }

inline std::string link(const std::string& name, const std::string& body = std::string(kInertial)) {
  return "<link name=\"" + name + "\">" + body + "</link>\n";
}

inline std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                         const std::string& child, const std::string& body = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + body + "</joint>\n";
}

inline constexpr const char* kHinge =
    "<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\"/>";

/// Two links joined by one joint; the joint is in line 4.
inline std::string two_links(const std::string& type, const std::string& joint_body) {
  return robot(link("a") + link("b") + joint("j", type, "a", "b", joint_body));
}

inline LoadedModel load(const std::string& text, const UrdfOptions& options = {}) {
  return load_urdf_string(text, "r.urdf", ".", options);
}

/// What the error says, or "" if there is none.
inline std::string error_of(const std::string& text, const UrdfOptions& options = {}) {
  try {
    const LoadedModel loaded = load(text, options);
  } catch (const UrdfError& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

/// A folder that is removed at the end, with what was written into it.
class ScratchFolder {
 public:
  ScratchFolder() {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            ("manyhands_" + std::string(test->test_suite_name()) + "_" + test->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
    path_ = std::filesystem::canonical(path_);
  }
  ~ScratchFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }

 private:
  std::filesystem::path path_;
};

inline constexpr std::string_view kTetrahedronObj =
    "# a corner of a cube\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1/1 2/1 4/1\nf 1//1 4//1 3//1\nf -3 -2 -1\n";

}  // namespace manyhands::testing
