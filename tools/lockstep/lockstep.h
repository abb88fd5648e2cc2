// Link, clock and camera that connect the host to a simulation in the same process.
// SPDX-License-Identifier: Apache-2.0
//
// Host and simulation do not depend on each other; this module connects the two.
//
// Waiting advances the simulation. sleep_until() and read() step the simulation by whole milliseconds until
// the given time is reached or bytes have arrived. No wall clock is read. Single-threaded. The simulation
// must outlive all objects of this file.
#pragma once

#include "host/link/link.h"
#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"
#include "vision/image/frame.h"

namespace kaz::lockstep {

class LockstepClock final : public host::Clock {
 public:
  explicit LockstepClock(sim::Simulation& simulation) : simulation_(simulation) {}
  Time now() const override { return simulation_.time(); }
  Result<void> sleep_until(Time t) override;

 private:
  sim::Simulation& simulation_;
};

class LockstepLink final : public host::Link {
 public:
  explicit LockstepLink(sim::Simulation& simulation) : simulation_(simulation) {}
  std::string name() const override { return "the simulator"; }
  Time byte_time() const override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;

 private:
  sim::Simulation& simulation_;
};

// Keeps the simulation's eyes open during the lifetime of this object.
class LockstepCamera final : public vision::Camera {
 public:
  explicit LockstepCamera(sim::Simulation& simulation);
  ~LockstepCamera() override;
  const vision::CameraModel& model() const override { return model_; }
  Result<std::optional<vision::StereoPair>> poll() override;

 private:
  sim::Simulation& simulation_;
  vision::CameraModel model_;
};

}  // namespace kaz::lockstep
