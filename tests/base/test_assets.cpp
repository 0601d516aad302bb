#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "manyhands/base/assets.h"

namespace manyhands {
namespace {

TEST(Assets, FindsWhatShips) { EXPECT_TRUE(std::filesystem::exists(asset_path("panda/panda.urdf"))); }

TEST(Assets, SaysWhatIsMissingAndWhatToDo) {
  try {
    (void)asset_path("no/such.urdf");
    FAIL();
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    for (const std::string& part :
         {std::string("no/such.urdf"), asset_root().string(), std::string("MANYHANDS_ASSETS")}) {
      EXPECT_NE(message.find(part), std::string::npos) << message;
    }
  }
}

TEST(Assets, TheChosenFolderComesBeforeTheVariableAndThatBeforeTheSourceTree) {
  const std::filesystem::path source = asset_root();
  const char* before = std::getenv("MANYHANDS_ASSETS");
  const std::string saved = before == nullptr ? "" : before;
  setenv("MANYHANDS_ASSETS", "/of/the/variable", 1);
  EXPECT_EQ(asset_root(), "/of/the/variable");
  set_asset_root("/chosen");
  EXPECT_EQ(asset_root(), "/chosen");
  set_asset_root({});
  if (before == nullptr) {
    unsetenv("MANYHANDS_ASSETS");
  } else {
    setenv("MANYHANDS_ASSETS", saved.c_str(), 1);
  }
  EXPECT_EQ(asset_root(), source);
}

}  // namespace
}  // namespace manyhands
