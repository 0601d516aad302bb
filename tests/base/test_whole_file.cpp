// Files that appear whole or not at all, and files that must not be there yet.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <sstream>
#include <string>
#include <system_error>

#include "manyhands/base/system.h"
#include "manyhands/base/whole_file.h"

namespace manyhands {
namespace {

namespace fs = std::filesystem;

class WholeFile : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string text_of(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  const fs::path folder_ = fs::temp_directory_path() / ("manyhands_whole_file_" + std::to_string(system::process_id()));
};

TEST_F(WholeFile, IsWritten) {
  const std::string first(100'000, 'a'), second = "b";
  write_whole_file(folder_ / "file", {std::as_bytes(std::span(first)), std::as_bytes(std::span(second))});
  EXPECT_EQ(text_of(folder_ / "file"), first + second);
}

TEST_F(WholeFile, TakesThePlaceOfAnother) {
  write_whole_file(folder_ / "file", "old");
  write_whole_file(folder_ / "file", "new");
  EXPECT_EQ(text_of(folder_ / "file"), "new");
}

TEST_F(WholeFile, LeavesNothingBehindWhereItCannotBe) {
  fs::create_directories(folder_ / "file" / "is a folder");
  EXPECT_THROW(write_whole_file(folder_ / "file", "text"), std::system_error);
  EXPECT_THROW(write_whole_file(folder_ / "nowhere" / "file", "text"), std::system_error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(WholeFile, NewMeansThatNothingIsThere) {
  const auto code = [](const fs::path& path) {
    try {
      const system::NewFile file(path);
    } catch (const std::system_error& error) {
      return error.code();
    }
    return std::error_code();
  };
  EXPECT_EQ(code(folder_ / "file"), std::error_code());
  EXPECT_EQ(code(folder_ / "file"), std::errc::file_exists);
  fs::create_symlink(folder_ / "elsewhere", folder_ / "link");
  EXPECT_EQ(code(folder_ / "link"), std::errc::file_exists);
  EXPECT_FALSE(fs::exists(folder_ / "elsewhere"));
}

}  // namespace
}  // namespace manyhands
