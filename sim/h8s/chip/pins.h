// Pins of the 64-pin package: names, drivers, levels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "sim/h8s/cpu/types.h"

namespace kaz::h8s {

// All pins except the supply pins and the crystal pins. First the I/O pins by port and bit (port 5 has three
// pins), then the inputs of port 7, then the control inputs.
enum class Pin : std::uint8_t {
  // clang-format off
  p10, p11, p12, p13, p14, p15, p16, p17,
  p20, p21, p22, p23, p24, p25, p26, p27,
  p30, p31, p32, p33, p34, p35, p36, p37,
  p40, p41, p42, p43, p44, p45, p46, p47,
  p50, p51, p52,
  p60, p61, p62, p63, p64, p65, p66, p67,
  p70, p71, p72, p73, p74, p75, p76, p77,
  nmi, res, stby, md0, md1,
  // clang-format on
};
inline constexpr unsigned kPins = 56;

struct PinInfo {
  Pin pin = Pin::p10;
  int port = 0;  // port number 1..7; 0 for the control inputs
  int bit = 0;
  // All names that the pin has in single-chip modes, such as "P50" and "TxD0". The port name comes first.
  // Source: hardware manual, pin functions. Where the manual does not cover the 64-pin part, the names come
  // from related parts (docs/explanation/emulator.md).
  std::span<const std::string_view> names;
  bool input_only = false;
  // NMOS push-pull output: an external low level overrides the pin's high level without a conflict.
  bool weak_high = false;
  std::string_view name() const { return names.front(); }
};

// Returns the table of pins in the order of the enum Pin.
std::span<const PinInfo> pin_table();
const PinInfo& info(Pin pin);
// Finds a pin by any of its names, ignoring case: "P50", "txd0", "PW3", "TMO0", "AN7", "NMI".
std::optional<Pin> find_pin(std::string_view name);
// Returns the pin of a port; nullopt if that pin does not exist, for example P53.
std::optional<Pin> pin_of(int port, int bit);

// Source of a pin's level.
enum class Driver : std::uint8_t {
  nobody,   // an input that neither the board nor a pull-up drives
  pull_up,  // the chip's internal pull-up
  board,
  port,  // the port's latch
  pwm,   // 8-bit PWM
  pwmx,  // 14-bit PWM
  frt,   // free-running timer
  tmr,   // 8-bit timers
  sci,   // serial channel
  // The system clock. The clock's edges fall between two states and are not reported.
  clock,
};
std::string_view name(Driver driver);

struct PinState {
  // For Driver::nobody, `level` is Options::floating_level. For Driver::clock, `level` is false.
  bool level = false;
  Driver driver = Driver::nobody;
  // True: PCR has switched the pull-up on. The pull-up can be on even while the pin is driven.
  bool pull_up = false;
  // Returns whether the chip drives the pin.
  bool output() const { return driver >= Driver::port; }
  bool operator==(const PinState&) const = default;
};

struct PinEdge {
  Pin pin = Pin::p10;
  bool level = false;              // level after the edge
  Driver driver = Driver::nobody;  // driver after the edge
  States at = 0;
};

using PinListener = std::function<void(const PinEdge&)>;

}  // namespace kaz::h8s
