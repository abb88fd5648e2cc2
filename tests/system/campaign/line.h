// Host and emulated board in one process, on a line that can be cut at any time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/link/link.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::campaign {

enum class Line {
  whole,
  cut,      // nothing passes in either direction: the cable is pulled, the ports stay
  gone,     // the host's port is gone
  garbled,  // every byte to the board is damaged, none comes back
};

// Link and clock of the host's client over a simulation; waiting advances it. After each
// millisecond `each_ms` is called, for checks and for events.
class CuttableLine final : public host::Link, public host::Clock {
 public:
  // The simulation must have the mcu h8.
  explicit CuttableLine(sim::Simulation& simulation);

  std::string name() const override { return "line"; }
  Time byte_time() const override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  Time now() const override { return simulation_.time(); }
  Result<void> sleep_until(Time t) override;

  void set(Line line) { line_ = line; }
  // Arrival time at the board of the last undamaged byte that was written.
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
