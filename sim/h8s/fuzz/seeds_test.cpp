// Every seed of the fuzzer, and inputs made at random, as ordinary tests.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <vector>

#include "sim/h8s/fuzz/targets.h"

namespace kaz::h8s::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  return {bytes.begin(), bytes.end()};
}

void replay(const std::string& target, const std::function<std::string(Bytes)>& run) {
  int seeds = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(KAZ_H8S_SEEDS) / target)) {
    ++seeds;
    EXPECT_EQ(run(content(entry.path())), "") << entry.path();
  }
  EXPECT_GT(seeds, 0);
}

Image mix() {
  auto loaded = load_image(std::string(KAZ_H8S_GUESTS) + "/mix.coff");
  EXPECT_TRUE(loaded.has_value()) << loaded.error().message;
  return loaded.value_or(Image{});
}

TEST(FuzzSeeds, Image) {
  replay("image", image);
}
TEST(FuzzSeeds, Chip) {
  replay("chip", chip);
}
TEST(FuzzSeeds, Flipped) {
  const Image base = mix();
  replay("flipped", [&](Bytes input) { return flipped(base, input); });
}

TEST(FuzzSeeds, Gdb) {
  replay("gdb", gdb);
}
TEST(FuzzSeeds, Netlist) {
  replay("netlist", netlist);
}

// A fixed stream of inputs; the fuzzer finds better ones, but not in every build.
TEST(FuzzRandom, ChipStaysTheSameInEveryEngine) {
  std::mt19937 random(7);
  for (int k = 0; k < 300; ++k) {
    std::vector<std::uint8_t> input(random() % 600 + 8);
    for (std::uint8_t& byte : input) byte = static_cast<std::uint8_t>(random());
    input[2] = 0;
    ASSERT_EQ(chip(input), "") << k;
  }
}

TEST(FuzzRandom, FlippedBitsNeverBreakTheEmulator) {
  const Image base = mix();
  std::mt19937 random(8);
  for (int k = 0; k < 60; ++k) {
    std::vector<std::uint8_t> input(random() % 100 + 8);
    for (std::uint8_t& byte : input) byte = static_cast<std::uint8_t>(random());
    ASSERT_EQ(flipped(base, input), "") << k;
  }
}

}  // namespace
}  // namespace kaz::h8s::fuzz
