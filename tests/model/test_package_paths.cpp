// Where meshes are looked for, and what may not be read.
#include <cstdlib>
#include <optional>

#include "manyhands/model/io/package_paths.h"
#include "tests/model/urdf_testing.h"

namespace manyhands::testing {
namespace {

namespace fs = std::filesystem;
using io::PackagePaths;
using io::PathEscape;

/// Sets an environment variable until the end of the test.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    setenv(name, value.c_str(), 1);
  }
  ~Variable() { old_ ? setenv(name_, old_->c_str(), 1) : unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> old_;
};

class PackagePathsTest : public ::testing::Test {
 protected:
  ScratchFolder scratch_;
  Variable ros_{"ROS_PACKAGE_PATH", ""};
  Variable ament_{"AMENT_PREFIX_PATH", ""};

  [[nodiscard]] fs::path at(const std::string& name) const { return scratch_.path() / name; }
};

TEST_F(PackagePathsTest, RelativeAndFileNames) {
  scratch_.write("robot/meshes/a b.stl", "x");
  const PackagePaths paths(at("robot"), {}, false);
  EXPECT_EQ(paths.resolve("meshes/a b.stl"), at("robot/meshes/a b.stl"));
  EXPECT_EQ(paths.resolve("meshes/../meshes/./a b.stl"), at("robot/meshes/a b.stl"));
  EXPECT_EQ(paths.resolve("file://" + at("robot/meshes/a%20b.stl").string()), at("robot/meshes/a b.stl"));
  EXPECT_EQ(paths.resolve(at("robot/meshes/a b.stl").string()), at("robot/meshes/a b.stl"));
  EXPECT_THROW((void)paths.resolve("meshes/none.stl"), std::runtime_error);
  EXPECT_THROW((void)paths.resolve("meshes"), std::runtime_error);  // a folder is no file
}

TEST_F(PackagePathsTest, PackagesOfTheOption) {
  scratch_.write("x/arm/m.stl", "x");
  EXPECT_EQ(PackagePaths(at("robot"), {at("x")}, false).resolve("package://arm/m.stl"), at("x/arm/m.stl"));
  EXPECT_EQ(PackagePaths(at("robot"), {at("x/arm")}, false).resolve("package://arm/m.stl"), at("x/arm/m.stl"));
  EXPECT_EQ(PackagePaths(at("robot"), {at("x")}, false).resolve("model://arm/m.stl"), at("x/arm/m.stl"));
  EXPECT_THROW((void)PackagePaths(at("robot"), {}, false).resolve("package://arm/m.stl"), std::runtime_error);
}

TEST_F(PackagePathsTest, PackagesOfTheEnvironment) {
  scratch_.write("ros/repository/arm/m.stl", "x");
  scratch_.write("install/share/hand/m.stl", "x");
  const Variable ros("ROS_PACKAGE_PATH", "/nowhere:" + at("ros").string());
  const Variable ament("AMENT_PREFIX_PATH", at("install").string() + ":");
  const PackagePaths paths(at("robot"), {}, false);
  EXPECT_EQ(paths.resolve("package://arm/m.stl"), at("ros/repository/arm/m.stl"));
  EXPECT_EQ(paths.resolve("package://hand/m.stl"), at("install/share/hand/m.stl"));
}

TEST_F(PackagePathsTest, PackagesAboveTheFile) {
  scratch_.write("src/arm/urdf/here.txt", "x");
  scratch_.write("src/arm/meshes/m.stl", "x");
  scratch_.write("src/checkout-2/package.xml", "<package>\n<name> hand </name></package>");
  scratch_.write("src/checkout-2/urdf/m.stl", "x");
  EXPECT_EQ(PackagePaths(at("src/arm/urdf"), {}, false).resolve("package://arm/meshes/m.stl"),
            at("src/arm/meshes/m.stl"));
  EXPECT_EQ(PackagePaths(at("src/arm"), {}, false).resolve("package://meshes/m.stl"), at("src/arm/meshes/m.stl"));
  EXPECT_EQ(PackagePaths(at("src/checkout-2/urdf"), {}, false).resolve("package://hand/urdf/m.stl"),
            at("src/checkout-2/urdf/m.stl"));
}

TEST_F(PackagePathsTest, AFolderAboveIsAPackageIfItSaysSo) {
  scratch_.write("work/robots/arm/here.txt", "x");
  scratch_.write("work/documents/secret.stl", "x");
  const PackagePaths paths(at("work/robots/arm"), {}, false);
  EXPECT_THROW((void)paths.resolve("package://documents/secret.stl"), std::runtime_error);
  scratch_.write("work/documents/package.xml", "<package><name>documents</name></package>");
  EXPECT_EQ(paths.resolve("package://documents/secret.stl"), at("work/documents/secret.stl"));
}

TEST_F(PackagePathsTest, ThePackageOfTheFileMayBeReached) {
  scratch_.write("arm/package.xml", "<package><name>arm</name></package>");
  scratch_.write("arm/meshes/m.stl", "x");
  scratch_.write("arm/urdf/here.txt", "x");
  EXPECT_EQ(PackagePaths(at("arm/urdf"), {}, false).resolve("../meshes/m.stl"), at("arm/meshes/m.stl"));
}

TEST_F(PackagePathsTest, PythonPackagesAndProjectsMayBeReached) {
  scratch_.write("secret.stl", "x");
  scratch_.write("project/lib/arms/__init__.py", "");
  scratch_.write("project/lib/arms/robots/__init__.py", "");
  scratch_.write("project/lib/arms/meshes/m.stl", "x");
  scratch_.write("project/lib/m.stl", "x");
  const fs::path folder = at("project/lib/arms/robots/assets");  // without a mark of its own
  scratch_.write("project/lib/arms/robots/assets/here.txt", "x");
  EXPECT_EQ(PackagePaths(folder, {}, false).resolve("../../meshes/m.stl"), at("project/lib/arms/meshes/m.stl"));
  EXPECT_THROW((void)PackagePaths(folder, {}, false).resolve("../../../m.stl"), PathEscape);
  scratch_.write("project/lib/pyproject.toml", "");  // the package is at its project's top
  EXPECT_EQ(PackagePaths(folder, {}, false).resolve("../../../m.stl"), at("project/lib/m.stl"));
  EXPECT_THROW((void)PackagePaths(folder, {}, false).resolve("../../../../../secret.stl"), PathEscape);
}

TEST_F(PackagePathsTest, NeitherAHomeNorASharedFolderIsAPackage) {
  scratch_.write("home/secret.stl", "x");
  scratch_.write("home/pyproject.toml", "");
  scratch_.write("home/robot/here.txt", "x");
  EXPECT_EQ(PackagePaths(at("home/robot"), {}, false).resolve("../secret.stl"), at("home/secret.stl"));
  {
    const Variable home("HOME", at("home").string());
    EXPECT_THROW((void)PackagePaths(at("home/robot"), {}, false).resolve("../secret.stl"), PathEscape);
  }
  fs::permissions(at("home"), fs::perms::sticky_bit, fs::perm_options::add);
  EXPECT_THROW((void)PackagePaths(at("home/robot"), {}, false).resolve("../secret.stl"), PathEscape);
}

TEST_F(PackagePathsTest, NothingOutsideMayBeReached) {
  scratch_.write("secret.stl", "x");
  scratch_.write("robot-secrets/m.stl", "x");
  scratch_.write("robot/m.stl", "x");
  fs::create_symlink(at("secret.stl"), at("robot/link.stl"));
  fs::create_directory_symlink(scratch_.path(), at("robot/up"));
  const PackagePaths paths(at("robot"), {}, false);
  for (const std::string& name :
       {std::string("../secret.stl"), std::string("../robot-secrets/m.stl"), std::string("link.stl"),
        std::string("up/secret.stl"), std::string("./x/../../secret.stl"), at("secret.stl").string(),
        "file://" + at("secret.stl").string(), "file://" + at("robot/%2e%2e/secret.stl").string(),
        std::string("package://robot/../secret.stl"), std::string("package://robot/up/secret.stl"),
        std::string("/etc/passwd"), std::string("../../../../../../../../../etc/passwd")}) {
    EXPECT_THROW((void)paths.resolve(name), PathEscape) << name;
  }
  EXPECT_THROW((void)paths.resolve("package://../secret.stl"), std::runtime_error);
  EXPECT_THROW((void)paths.resolve("package:///secret.stl"), std::runtime_error);
  EXPECT_EQ(PackagePaths(at("robot"), {}, true).resolve("../secret.stl"), at("secret.stl"));
  EXPECT_EQ(PackagePaths(at("robot"), {}, true).resolve("link.stl"), at("secret.stl"));
}

TEST_F(PackagePathsTest, AnEscapeIsAnErrorOfTheLoader) {
  scratch_.write("secret.obj", kTetrahedronObj);
  const std::string text = robot(
      link("a", std::string(kInertial) + "\n<visual><geometry><mesh filename=\"../secret.obj\"/></geometry></visual>"));
  const fs::path file = scratch_.write("robot/r.urdf", text);
  try {
    const LoadedModel loaded = load_urdf(file);
    FAIL();
  } catch (const UrdfError& error) {
    EXPECT_EQ(error.line(), 3);
    EXPECT_PRED2(contains, error.what(), "expected a file inside it, or the option allow_outside_package");
  }
  EXPECT_EQ(load_urdf(file, {.allow_outside_package = true}).model.geoms().size(), 1u);
}

}  // namespace
}  // namespace manyhands::testing
