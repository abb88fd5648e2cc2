// Waiting is what moves simulated time.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/lockstep.h"

namespace kaz::lockstep {

Result<void> LockstepClock::sleep_until(Time t) {
  while (simulation_.time() < t) {
    if (auto stepped = simulation_.step(); !stepped) return stepped;
  }
  return {};
}

Time LockstepLink::byte_time() const {
  return sim::time_of(KZ_STATES_PER_BYTE);
}

Result<void> LockstepLink::write(std::span<const std::uint8_t> bytes) {
  if (const auto& error = simulation_.error()) return tl::unexpected(*error);
  simulation_.write(bytes);
  return {};
}

Result<std::size_t> LockstepLink::read(std::span<std::uint8_t> bytes, Time deadline) {
  while (true) {
    if (const auto& error = simulation_.error()) return tl::unexpected(*error);
    const std::size_t count = simulation_.read(bytes);
    if (count > 0 || simulation_.time() >= deadline) return count;
    KAZ_TRY(simulation_.step());
  }
}

LockstepCamera::LockstepCamera(sim::Simulation& simulation)
    : simulation_(simulation), model_(simulation.camera().model()) {
  simulation_.open_eyes();
}

LockstepCamera::~LockstepCamera() {
  simulation_.close_eyes();
}

Result<std::optional<vision::StereoPair>> LockstepCamera::poll() {
  if (const auto& error = simulation_.error()) return tl::unexpected(*error);
  if (!simulation_.has_eyes()) return tl::unexpected(sim::Simulation::no_eyes());
  return simulation_.next_pair();
}

}  // namespace kaz::lockstep
