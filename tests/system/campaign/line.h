// Serial line between host and emulated board in one process, which can be cut at any time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "host/link/link.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::campaign {

enum class Line {
  whole,
  cut,      // no byte passes: the cable is pulled, the ports stay
  gone,     // the host's port is gone
  garbled,  // every byte to the board is damaged, and none passes to the host
};

// Link and clock of the host's client over a simulation. Waiting advances it and calls `each_ms` after each
// millisecond, for checks and events.
class CuttableLine final : public host::Link, public host::Clock {
 public:
  // `simulation` must use h8 and outlive this object.
  explicit CuttableLine(sim::Simulation& simulation);

  std::string name() const override { return "line"; }
  Time byte_time() const override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  Time now() const override { return simulation_.time(); }
  Result<void> sleep_until(Time t) override;

  void set(Line line) { line_ = line; }
  // Returns the arrival time at the board of the last byte that was written undamaged.
  sim::States last_arrival() const { return last_arrival_; }
  sim::Simulation& simulation() { return simulation_; }
  sim::H8Mcu& mcu() { return mcu_; }
  std::function<void()> each_ms;

 private:
  Result<void> step();

  sim::Simulation& simulation_;
  sim::H8Mcu& mcu_;
  Line line_ = Line::whole;
  sim::States last_arrival_ = 0;
};

}  // namespace kaz::campaign
