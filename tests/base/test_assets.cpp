#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "manyhands/base/assets.h"

namespace manyhands {
namespace {

TEST(Assets, FindsWhatShips) { EXPECT_TRUE(std::filesystem::exists(asset_path("panda/panda.urdf"))); }

void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Assets, ANameThatIsNotThereIsAnsweredByThoseThatAre) {
  try {
    (void)asset_path("no/such.urdf");
    FAIL();
  } catch (const AssetNotFound& error) {
    expect_parts(error.what(), {"no/such.urdf", asset_root().string(), "'arm6/arm6.urdf', ",
                                " models in 'bullet', 'panda/panda.urdf'"});
  }
}

TEST(Assets, AMissingFolderSaysWhatToDo) {
  set_asset_root("/no/such/folder");
  try {
    (void)asset_path("panda/panda.urdf");
    ADD_FAILURE();
  } catch (const AssetNotFound& error) {
    ADD_FAILURE() << error.what();
  } catch (const std::runtime_error& error) {
    expect_parts(error.what(), {"panda/panda.urdf", "/no/such/folder", "MANYHANDS_ASSETS"});
  }
  set_asset_root({});
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
