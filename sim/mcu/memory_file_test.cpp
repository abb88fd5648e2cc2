// A board's non-volatile memory in a file.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/memory_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace kaz::sim {
namespace {

class MemoryFile : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("kaz-memory-" + std::to_string(::getpid()));
  const std::string path = folder / "board";
};

TEST_F(MemoryFile, ComesBackAsItWas) {
  auto mcu = make_native();
  std::array<std::uint8_t, Mcu::kMemorySize> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  mcu->set_memory(bytes);
  ASSERT_TRUE(save_memory(*mcu, path));
  EXPECT_EQ(std::filesystem::file_size(path), Mcu::kMemorySize);
  ASSERT_TRUE(save_memory(*mcu, path)) << "it may be there already";
  auto other = make_native();
  ASSERT_TRUE(load_memory(*other, path));
  EXPECT_EQ(other->memory(), bytes);
}

TEST_F(MemoryFile, AMissingFileIsABlankBoard) {
  auto mcu = make_native();
  ASSERT_TRUE(load_memory(*mcu, path));
  const auto memory = mcu->memory();
  EXPECT_TRUE(std::all_of(memory.begin(), memory.end(), [](u8 byte) { return byte == 0xFF; }));
}

TEST_F(MemoryFile, SaysWhatIsWrong) {
  auto mcu = make_native();
  for (const std::size_t size : {std::size_t{0}, Mcu::kMemorySize - 1, Mcu::kMemorySize + 1}) {
    std::ofstream(path, std::ios::binary) << std::string(size, 'x');
    const auto loaded = load_memory(*mcu, path);
    ASSERT_FALSE(loaded) << size;
    EXPECT_EQ(loaded.error().fault, Fault::usage);
    EXPECT_NE(loaded.error().message.find(path), std::string::npos);
  }
  const auto saved = save_memory(*mcu, folder / "nowhere" / "board");
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().fault, Fault::environment);
}

}  // namespace
}  // namespace kaz::sim
