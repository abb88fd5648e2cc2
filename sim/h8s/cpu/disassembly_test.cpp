// The disassembler's text of every form, read back by GNU's assembler, gives the same bytes.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "sim/h8s/cpu/opcode.h"
#include "sim/h8s/cpu/oracle_model_testing.h"

namespace kaz::h8s::oracle {
namespace {

namespace fs = std::filesystem;

// Branches are skipped: the assembler chooses the size that their text does not contain.
bool is_branch(const Form& f) {
  return f.name.rfind("bcc", 0) == 0 || f.name.rfind("bsr", 0) == 0;
}

std::vector<u16> random_units(const Form& f, std::mt19937& random) {
  std::vector<u16> units(static_cast<std::size_t>(f.units()));
  for (std::size_t k = 0; k < f.bits.size(); ++k) {
    const bool one = f.bits[k] >= 'a' ? random() % 2 != 0 : f.bits[k] == '1';
    units[k / 16] = static_cast<u16>(units[k / 16] * 2 + (one ? 1 : 0));
  }
  if (f.name.rfind("jmp", 0) == 0 || f.name.rfind("jsr", 0) == 0) units.back() &= 0xfffe;
  return units;
}

TEST(Disassembly, GoesBackThroughTheAssembler) {
  const fs::path folder = fs::path(::testing::TempDir()) / "kaz_h8s_disassembly";
  fs::create_directories(folder);
  std::vector<std::uint8_t> wanted;
  std::vector<std::string> lines;
  {
    std::ofstream source(folder / "all.s");
    source << "  .h8300s\n  .section .text\n";
    std::mt19937 random(3);
    for (const Form& f : forms()) {
      for (int k = 0; k < 8 && !is_branch(f); ++k) {
        const std::vector<u16> units = random_units(f, random);
        int bytes = 0;
        lines.push_back(disassemble(units, 0x1000 + static_cast<u32>(wanted.size()), &bytes));
        ASSERT_EQ(bytes, 2 * f.units()) << f.name;
        source << "  " << lines.back() << '\n';
        for (const u16 unit : units) {
          wanted.push_back(static_cast<std::uint8_t>(unit >> 8));
          wanted.push_back(static_cast<std::uint8_t>(unit));
        }
      }
    }
  }
  const std::string in = "cd '" + folder.string() + "' && ";
  const std::string commands = in + KAZ_H8S_AS + " all.s -o all.o && " + KAZ_H8S_LD +
                               " -m h8300s -Ttext 0x1000 -e 0x1000 all.o -o all.x && " +
                               KAZ_H8S_OBJCOPY + " -O binary -j .text all.x all.bin";
  ASSERT_EQ(std::system(commands.c_str()), 0) << commands;
  std::ifstream file(folder / "all.bin", std::ios::binary);
  const std::vector<char> content{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::uint8_t> got(content.begin(), content.end());
  ASSERT_EQ(got.size(), wanted.size());
  EXPECT_GT(lines.size(), 2500u);
  for (std::size_t k = 0; k < got.size(); ++k) {
    // The top bit of the register behind 78 means nothing.
    if (k % 2 == 1 && wanted[k - 1] == 0x78 && (got[k] ^ wanted[k]) == 0x80) continue;
    ASSERT_EQ(got[k], wanted[k]) << "offset " << k << " of " << (folder / "all.s");
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace kaz::h8s::oracle
