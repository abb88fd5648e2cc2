// Link, clock and camera that connect the host to a simulation in the same process.
// SPDX-License-Identifier: Apache-2.0
//
// Host and simulation do not depend on each other; this module connects the two.
//
// Waiting advances the simulation. A call of sleep_until() steps the simulation by whole milliseconds until
// the given time is reached. A call of read() steps the simulation by whole milliseconds until bytes have
// arrived or the deadline is reached. No wall clock is read. Single-threaded. The simulation must outlive all
// objects of this file.
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

// While this object exists, the simulation renders picture pairs (see Simulation::open_eyes()).
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
