// `wire_benchmark`: how much of the serial line a host needs for all joints, with the emulated firmware
// at its other end, as JSON for `kaz_benchmark`. Simulated time: the same on every machine.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <nlohmann/json.hpp>

#include "sim/mcu/h8_mcu.h"
#include "sim/runtime/simulation/world_testing.h"
#include "tools/lockstep/lockstep.h"
#include "tools/lockstep/wire_load_testing.h"

namespace {

using namespace kaz;

Result<lockstep::WireLoad> measure(double rate_hz) {
  auto chip = KAZ_TRY(sim::H8Mcu::load(KAZ_FIRMWARE_IMAGE));
  sim::SimulationOptions options;
  options.make_renderer = sim::make_test_renderer;
  auto simulation = KAZ_TRY(sim::Simulation::assemble(
      options, std::move(chip), std::make_unique<sim::TestWorld>(), sim::small_camera()));
  lockstep::LockstepClock clock(*simulation);
  lockstep::LockstepLink link(*simulation);
  auto robot = KAZ_TRY(host::Robot::connect(link, clock));
  return lockstep::run_wire_load(robot, link.byte_time(), rate_hz, std::chrono::seconds(5));
}

nlohmann::ordered_json json_of(const lockstep::WireLoad& load) {
  return {{"rate_hz", load.rate_hz},   {"share_out", load.share_out}, {"share_in", load.share_in},
          {"oldest_s", load.oldest_s}, {"late", load.late},           {"retries", load.retries}};
}

}  // namespace

int main() {
  nlohmann::ordered_json result;
  for (const auto& [name, rate] : {std::pair{"at_100_hz", 100.0}, std::pair{"fastest", 0.0}}) {
    const auto load = measure(rate);
    if (!load) {
      std::fprintf(stderr, "wire_benchmark: %s\n", load.error().message.c_str());
      return static_cast<int>(load.error().fault);
    }
    result[name] = json_of(*load);
  }
  std::printf("%s\n", result.dump(2).c_str());
  return 0;
}
