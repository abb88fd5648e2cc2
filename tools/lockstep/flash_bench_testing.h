// An emulated board on a bench in simulated time. Tests write the board's flash while faults occur.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "host/flash/board_reset.h"
#include "host/link/link.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/runtime/simulation/serial_line.h"

namespace kaz::lockstep {

// Link, clock and reset of one emulated board. Waiting advances simulated time in steps of 1/8 ms.
class FlashBench final : public host::Link, public host::Clock, public host::BoardReset {
 public:
  // `image`: path of kaz.mot; empty: the chip is erased. Aborts the program if the image cannot be loaded.
  explicit FlashBench(const std::string& image = "", const h8s::Options& options = {},
                      std::uint64_t seed = 1);

  // --- Simulated faults. The times of faults use the same time scale as now().
  void cut_power_at(Time when, Time length) { cut_at_ = when, cut_length_ = length; }
  // At the time `when` and later, read() and write() return Fault::environment.
  void unplug_at(Time when) { unplug_at_ = when; }
  // Sets the faults of the line; null: no faults. `faults` must outlive this object.
  void set_faults(const faults::Schedule* faults) { line_.set_faults(faults); }
  // Sets a function that is called each time the program counter enters the application. The call happens at
  // the end of the step of 1/8 ms.
  void on_application(std::function<void()> listener) { on_application_ = std::move(listener); }
  // Sets the latency of the serial adapter in each direction.
  void set_latency(Time latency);

  // --- host::Clock, host::Link, host::BoardReset
  Time now() const override;
  Result<void> sleep_until(Time t) override;
  std::string name() const override { return "bench"; }
  Result<void> set_baud(int baud) override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  Result<void> reset(bool boot) override;

  h8s::Chip& chip() { return mcu_->chip(); }
  sim::H8Mcu& mcu() { return *mcu_; }
  // Removes all faults, waits 200 ms, and discards unread bytes.
  void repair();
  // Returns the CRC of the running image, from the reply to `identify`. nullopt: the board did not reply.
  std::optional<std::uint16_t> running_image();

 private:
  Result<void> step();
  void watch();
  Error unplugged() const;

  std::unique_ptr<sim::H8Mcu> mcu_;
  sim::SerialLine line_;
  sim::States now_ = 0, off_ = 0, latency_ = 0;
  bool power_ = true, in_application_ = false;
  std::function<void()> on_application_;
  std::optional<Time> cut_at_, unplug_at_;
  Time cut_length_{};
};

}  // namespace kaz::lockstep
