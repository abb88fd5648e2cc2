// Translated code in the host's memory: no page that can be written to can be executed.
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

struct Mappings {
  int executable = 0;               // without a name: neither a program or library nor the kernel's
  std::string writable_executable;  // lines of /proc/self/maps
};

Mappings mappings() {
  Mappings found;
  std::ifstream maps("/proc/self/maps");
  EXPECT_TRUE(maps);
  for (std::string line; std::getline(maps, line);) {
    std::istringstream fields(line);
    std::string range, permissions, offset, device, inode, name;
    fields >> range >> permissions >> offset >> device >> inode >> name;
    if (permissions.find('x') == std::string::npos) continue;
    if (permissions.find('w') != std::string::npos) found.writable_executable += line + "\n";
    if (name.empty()) ++found.executable;
  }
  return found;
}

// Much code, all of it translated at once.
Chip translating_chip() {
  std::vector<std::uint16_t> words;
  for (int k = 0; k < 3000; ++k) words.insert(words.end(), {0x0b50, 0x0901});  // inc.w, add.w
  words.insert(words.end(), {0x5a00, static_cast<std::uint16_t>(kCode)});      // jmp to the start
  Options options;
  options.engine = Engine::translator;
  options.translate_after = 1;
  return make_chip(words, options);
}

TEST(CodeMemory, IsNeverWritableAndExecutable) {
  const int before = mappings().executable;
  Chip chip = translating_chip();
  EXPECT_EQ(mappings().executable, before) << "nothing has run yet";
  EXPECT_EQ(chip.run_until(chip.now() + 50'000).reason, Stop::Reason::reached);
  const Mappings with_code = mappings();
  EXPECT_GT(with_code.executable, before) << "nothing was translated: this shows nothing";
  EXPECT_EQ(with_code.writable_executable, "");
}

// Watched from another thread while code is made, forgotten and made again.
TEST(CodeMemory, IsNotWhileCodeIsMadeEither) {
  std::atomic<bool> done{false};
  std::string seen;
  std::thread watcher([&] {
    while (!done && seen.empty()) seen = mappings().writable_executable;
  });
  Chip chip = translating_chip();
  for (int k = 0; k < 40; ++k) {
    chip.power_on();  // the translator forgets all
    EXPECT_EQ(chip.run_until(chip.now() + 20'000).reason, Stop::Reason::reached);
  }
  done = true;
  watcher.join();
  EXPECT_EQ(seen, "");
}

}  // namespace
}  // namespace kaz::h8s::testing
