// Reference for the emulated firmware: computes each tick again with native code, and compares the results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "shared/servo/servo.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/mcu.h"

namespace kaz::fuzz {

class Shadow {
 public:
  // `h8` must outlive this object. The image of `h8` must have the symbols of the servo's tick.
  explicit Shadow(const sim::H8Mcu& h8) : h8_(&h8) {}

  // Computes the recorded tick with native code. Returns true if the tick is the first one after a reset.
  bool tick(const sim::TickRecord& record);
  const kz_servo& servo() const { return servo_; }
  // First difference between the native code and the emulated firmware. Outputs are compared in each tick,
  // the state only in every 64th tick.
  const std::optional<std::string>& difference() const { return difference_; }

 private:
  kz_startup startup() const;
  void compare_state(const kz_tick_input& input);
  void differ(const kz_tick_input& input, const std::string& what, long long here, long long there);

  const sim::H8Mcu* h8_;
  kz_servo servo_{};
  std::optional<std::uint32_t> last_tick_;
  long long ticks_ = 0;
  std::optional<std::string> difference_;
};

}  // namespace kaz::fuzz
