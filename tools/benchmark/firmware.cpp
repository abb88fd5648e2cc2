// The servo firmware under its walking load, in the emulator alone.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/walking_load_testing.h"
#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/engines.h"

namespace kaz::bench {
namespace {

Result<std::unique_ptr<sim::H8Mcu>> board_chip(const std::string& engine) {
  return sim::H8Mcu::load(KAZ_FIRMWARE_IMAGE, options_of(engine));
}

Result<void> walk(sim::WalkingLoad& load, int milliseconds) {
  for (int k = 0; k < milliseconds; ++k) {
    if (auto done = load.millisecond(); !done) return done;
  }
  return {};
}

Result<void> speed(const Settings& settings, const std::string& engine, Results& results) {
  auto mcu = KAZ_TRY(board_chip(engine));
  sim::WalkingLoad load(*mcu);
  if (auto started = load.start(); !started) return started;
  const int milliseconds = settings.quick ? 200 : 4000;
  std::vector<double> times, mips, mstates;
  for (int k = 0; k < settings.repeats; ++k) {
    const auto instructions = mcu->chip().instructions();
    const double from = cpu_seconds();
    if (auto done = walk(load, milliseconds); !done) return done;
    const double seconds = cpu_seconds() - from;
    times.push_back(milliseconds / 1e3 / seconds);
    const auto executed = mcu->chip().instructions() - instructions;
    mips.push_back(static_cast<double>(executed) / seconds / 1e6);
    mstates.push_back(static_cast<double>(milliseconds) * KZ_STATES_PER_TICK / seconds / 1e6);
  }
  results.put(named("mcu.firmware_x", engine), median(times));
  results.put(named("mcu.mips.firmware", engine), median(mips));
  results.put(named("mcu.mstates.firmware", engine), median(mstates));
  return {};
}

Result<void> host_per_guest(const Settings& settings, const std::string& engine, Results& results) {
  if (settings.quick) return {};
  constexpr int few = 50, many = 250;
  auto mcu = KAZ_TRY(board_chip(engine));
  sim::WalkingLoad load(*mcu);
  if (auto started = load.start(); !started) return started;
  if (auto done = walk(load, few); !done) return done;
  const auto before = mcu->chip().instructions();
  if (auto done = walk(load, many - few); !done) return done;
  const auto guest = static_cast<double>(mcu->chip().instructions() - before);
  const auto host = host_instructions("mcu.firmware_x", engine, few, many, results);
  if (host) results.put(named("mcu.host_per_guest.firmware", engine), *host / guest);
  return {};
}

// The firmware's own count of the states that its ticks take; the same on every machine.
Result<void> tick(const Settings& settings, Results& results) {
  auto mcu = KAZ_TRY(board_chip(settings.engines.front()));
  sim::WalkingLoad load(*mcu);
  if (auto started = load.start(); !started) return started;
  std::vector<double> busy;
  mcu->on_tick(
      [&](const sim::TickRecord& record) { busy.push_back(record.input.busy_8states * 8.0); });
  if (auto done = walk(load, settings.quick ? 500 : 3000); !done) return done;
  mcu->on_tick(nullptr);
  if (busy.empty())
    return fail(Fault::failed, "the firmware did not run a single tick during the measurement");
  results.put("mcu.tick_worst",
              100 * *std::max_element(busy.begin(), busy.end()) / KZ_STATES_PER_TICK);
  results.put("mcu.tick_median", 100 * median(busy) / KZ_STATES_PER_TICK);
  return {};
}

}  // namespace

Result<void> run_firmware(const std::string& engine, int milliseconds) {
  auto mcu = KAZ_TRY(board_chip(engine));
  sim::WalkingLoad load(*mcu);
  if (auto started = load.start(); !started) return started;
  return walk(load, milliseconds);
}

std::vector<Group> firmware_groups() {
  return {
      each_engine({"mcu.firmware_x", "mcu.mips.firmware", "mcu.mstates.firmware"}, speed),
      each_engine({"mcu.host_per_guest.firmware"}, host_per_guest),
      {{"mcu.tick_worst", "mcu.tick_median"}, tick},
  };
}

}  // namespace kaz::bench
