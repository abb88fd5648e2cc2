// Passes, drops or damages bytes, by the state of the line.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/campaign/line.h"

namespace kaz::campaign {
namespace {

Error gone() {
  return {Fault::environment, "the port is gone"};
}

}  // namespace

CuttableLine::CuttableLine(sim::Simulation& simulation)
    : simulation_(simulation), mcu_(dynamic_cast<sim::H8Mcu&>(simulation.board().mcu())) {}

Time CuttableLine::byte_time() const {
  return sim::time_of(KZ_STATES_PER_BYTE);
}

Result<void> CuttableLine::write(std::span<const std::uint8_t> bytes) {
  const sim::States now = simulation_.now();
  switch (line_) {
    case Line::whole:
      simulation_.write(bytes);
      last_arrival_ =
          now + static_cast<sim::States>(simulation_.line().waiting(now)) * KZ_STATES_PER_BYTE;
      break;
    case Line::cut:
      break;
    case Line::gone:
      return tl::unexpected(gone());
    case Line::garbled:
      simulation_.line().write_garbled(bytes, now);
      break;
  }
  return {};
}

Result<std::size_t> CuttableLine::read(std::span<std::uint8_t> bytes, Time deadline) {
  while (true) {
    if (line_ == Line::gone) {
      // Simulated time must advance even if the client polls in a loop.
      KAZ_TRY(step());
      return tl::unexpected(gone());
    }
    if (line_ != Line::whole) simulation_.line().drop_unread();
    const std::size_t count = simulation_.read(bytes);
    if (count > 0 || simulation_.time() >= deadline) return count;
    KAZ_TRY(step());
  }
}

Result<void> CuttableLine::sleep_until(Time t) {
  while (simulation_.time() < t) {
    if (auto stepped = step(); !stepped) return stepped;
  }
  return {};
}

Result<void> CuttableLine::step() {
  auto stepped = simulation_.step();
  if (stepped && each_ms) each_ms();
  return stepped;
}

}  // namespace kaz::campaign
