// Host and simulation in one process: the host's interfaces over simulated time.
// SPDX-License-Identifier: Apache-2.0
//
// The only place where the two meet.
//
// Whoever waits advances the world: sleep_until() and read() run the simulation by whole
// milliseconds until the time has come or bytes have. Nothing reads the wall clock. One thread.
#pragma once

#include "host/link/link.h"
#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"
#include "vision/image/frame.h"

namespace kaz::lockstep {

class LockstepClock final : public host::Clock {
 public:
  // The simulation must outlive what stands on it.
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

// Keeps the simulation's eyes open.
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
