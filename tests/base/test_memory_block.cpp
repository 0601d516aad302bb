#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include "manyhands/base/memory_block.h"

namespace manyhands {
namespace {

std::filesystem::path empty_folder(const char* name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

TEST(MemoryBlock, IsZeroAndKeepsWhatIsWritten) {
  for (const std::filesystem::path& folder : {std::filesystem::path(), empty_folder("blocks")}) {
    constexpr int kCount = 1 << 20;
    MemoryBlock block(kCount * sizeof(std::int32_t), folder);
    auto* numbers = block.as<std::int32_t>();
    for (int i = 0; i < kCount; ++i) {
      ASSERT_EQ(numbers[i], 0);
      numbers[i] = 7 * i;
    }
    const MemoryBlock moved = std::move(block);
    for (int i = 0; i < kCount; ++i) ASSERT_EQ(moved.as<std::int32_t>()[i], 7 * i);
  }
}

TEST(MemoryBlock, LeavesNothingInTheFolder) {
  const std::filesystem::path folder = empty_folder("nameless_blocks");
  const MemoryBlock block(4096, folder);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(MemoryBlock, NamesTheFolderThatCannotHoldIt) {
  try {
    const MemoryBlock block(std::size_t{3} << 20, "/nowhere/at all");
    FAIL();
  } catch (const std::system_error& error) {
    EXPECT_STREQ(error.what(), "cannot keep 3 MB in a file in '/nowhere/at all': No such file or directory");
  }
  const std::filesystem::path folder = empty_folder("small_disk");
  EXPECT_THROW(MemoryBlock(std::size_t{1} << 60, folder), std::system_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace
}  // namespace manyhands
