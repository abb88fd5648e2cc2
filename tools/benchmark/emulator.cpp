// Speed of the emulator by itself: guest programs that touch no registers.
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "sim/h8s/chip/chip.h"
#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/engines.h"

namespace kaz::bench {
namespace {

// Rounds that take some 0.1 s at 300 million instructions per second.
struct Guest {
  const char* name;
  int rounds;
};
constexpr std::array<Guest, 3> kGuests{{{"crc", 600}, {"matrix", 700}, {"mix", 20'000}}};

Result<h8s::Chip> guest_chip(const std::string& guest, const std::string& engine) {
  const std::string file = std::string(KAZ_H8S_GUESTS) + "/" + guest + ".coff";
  const auto image = h8s::load_image(file);
  if (!image) return fail(Fault::environment, image.error().message);
  h8s::Chip chip(options_of(engine));
  if (auto loaded = chip.load(*image); !loaded)
    return fail(Fault::environment, file + ": " + loaded.error().message);
  return chip;
}

struct Run {
  double seconds = 0, instructions = 0, states = 0;
};

// From reset to the end of main, so often as `rounds` says. The same chip runs again and again: what
// it has decoded or translated stays.
Result<Run> run_rounds(h8s::Chip& chip, int rounds) {
  chip.reset();
  const std::uint32_t at = chip.symbols().address_of("rounds").value();
  chip.poke(at, static_cast<std::uint8_t>(rounds >> 8));
  chip.poke(at + 1, static_cast<std::uint8_t>(rounds));
  const auto instructions = chip.instructions();
  const auto states = chip.now();
  const double from = cpu_seconds();
  const h8s::Stop stop = chip.run_until(states + 100'000'000'000);
  Run run;
  run.seconds = cpu_seconds() - from;
  if (stop.reason != h8s::Stop::Reason::asleep_forever)
    return fail(Fault::failed, "a guest program did not end: " + stop.report);
  run.instructions = static_cast<double>(chip.instructions() - instructions);
  run.states = static_cast<double>(chip.now() - states);
  return run;
}

Result<void> measure(const Guest& guest, const Settings& settings, const std::string& engine,
                     Results& results) {
  auto chip = KAZ_TRY(guest_chip(guest.name, engine));
  chip.power_on(0);
  const int rounds = settings.quick ? guest.rounds / 20 : guest.rounds;
  std::vector<double> mips, mstates;
  for (int k = -1; k < settings.repeats; ++k) {
    const auto run = KAZ_TRY(run_rounds(chip, rounds));
    if (k < 0) continue;  // what is done once
    mips.push_back(run.instructions / run.seconds / 1e6);
    mstates.push_back(run.states / run.seconds / 1e6);
  }
  const std::string name = guest.name;
  results.put(named("mcu.mips." + name, engine), median(mips));
  results.put(named("mcu.mstates." + name, engine), median(mstates));
  return {};
}

Result<void> host_per_guest(const Guest& guest, const Settings& settings, const std::string& engine,
                            Results& results) {
  if (settings.quick) return {};
  auto chip = KAZ_TRY(guest_chip(guest.name, engine));
  chip.power_on(0);
  const int few = guest.rounds / 100, many = 2 * few;
  std::array<double, 2> instructions{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto run = KAZ_TRY(run_rounds(chip, k == 0 ? few : many));
    instructions[k] = run.instructions;
  }
  const std::string name = guest.name;
  const auto host = host_instructions("mcu.mips." + name, engine, few, many, results);
  if (host)
    results.put(named("mcu.host_per_guest." + name, engine),
                *host / (instructions[1] - instructions[0]));
  return {};
}

}  // namespace

Result<void> run_guest(const std::string& guest, const std::string& engine, int rounds) {
  auto chip = KAZ_TRY(guest_chip(guest, engine));
  chip.power_on(0);
  const auto run = run_rounds(chip, rounds);
  if (!run) return tl::unexpected(run.error());
  return {};
}

std::vector<Group> emulator_groups() {
  std::vector<Group> groups;
  for (const Guest& guest : kGuests) {
    const std::string name = guest.name;
    groups.push_back(each_engine({"mcu.mips." + name, "mcu.mstates." + name},
                                 [&guest](const auto& settings, const auto& engine, auto& results) {
                                   return measure(guest, settings, engine, results);
                                 }));
    groups.push_back(each_engine({"mcu.host_per_guest." + name},
                                 [&guest](const auto& settings, const auto& engine, auto& results) {
                                   return host_per_guest(guest, settings, engine, results);
                                 }));
  }
  return groups;
}

}  // namespace kaz::bench
