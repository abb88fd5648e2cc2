// Prints how many randomly damaged frames pass the CRC, beside what theory allows.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/integration/damage/damage.h"

namespace {

constexpr const char* kHelp =
    "usage: kaz_damage [--frames N] [--seed N]\n"
    "\n"
    "Sends N (10 million) randomly damaged frames to the native board while its joints move, and\n"
    "prints how many pass the CRC, and whether one of them moved a joint out of its limits.\n"
    "\n"
    "examples:\n"
    "  kaz_damage\n"
    "  kaz_damage --frames 100000 --seed 7\n"
    "\n"
    "exit codes: 0 as it should be, 1 a frame with one damaged byte passed or a joint left its\n"
    "limits, 2 wrong usage\n";

bool number(const char* text, unsigned long long& value) {
  char* end = nullptr;
  value = std::strtoull(text, &end, 10);
  return *text >= '0' && *text <= '9' && *end == 0;
}

}  // namespace

int main(int count, char** arguments) {
  unsigned long long frames = 10'000'000, seed = 1;
  for (int i = 1; i < count; ++i) {
    const std::string name = arguments[i];
    if (name == "--help") {
      std::fputs(kHelp, stdout);
      return 0;
    }
    unsigned long long* const value =
        name == "--frames" ? &frames : (name == "--seed" ? &seed : nullptr);
    if (!value || ++i == count || !number(arguments[i], *value)) {
      std::fprintf(stderr, "kaz_damage: '%s' is no option with a number; see --help\n",
                   name.c_str());
      return 2;
    }
  }
  const kaz::test::DamageReport report = kaz::test::measure_damage(frames, seed);
  std::printf("%-32s %10s %10s %10s\n", "damage", "frames", "pass CRC", "accepted");
  for (const kaz::test::Damage& kind : report.kinds)
    std::printf("%-32s %10llu %10llu %10llu\n", kind.name,
                static_cast<unsigned long long>(kind.frames),
                static_cast<unsigned long long>(kind.passed),
                static_cast<unsigned long long>(kind.accepted));
  const double expected = static_cast<double>(report.frames()) / 65536;
  std::printf("more than one byte: %llu of %llu pass; theory, 2^-16: %.0f +- %.0f\n",
              static_cast<unsigned long long>(report.passed()),
              static_cast<unsigned long long>(report.frames()), expected, std::sqrt(expected));
  std::printf(
      "%llu ticks, %.0f %% with motors on; joints moved %.0f rad; commands out of limits: "
      "%llu; furthest joint: %d of 100 urad beyond its limit\n",
      static_cast<unsigned long long>(report.ticks),
      100.0 * static_cast<double>(report.ticks_on) / static_cast<double>(report.ticks),
      report.furthest_moved, static_cast<unsigned long long>(report.commands_outside),
      report.furthest_outside);
  const bool right = report.kinds[0].passed == 0 && report.commands_outside == 0;
  return right ? 0 : 1;
}
