// What a board needs of servos on a bus, whatever their protocol.
// SPDX-License-Identifier: Apache-2.0
//
// Positions in steps of a servo's sensor, speeds in steps/s. A request that is not answered is sent once
// more; then its answer is missing, and counted. Errors are the port's alone.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "host/link/link.h"
#include "shared/servo_bus/bus_file.h"

namespace kaz::host {

// What a servo says is wrong with it.
enum ServoTrouble : std::uint8_t {
  kTroubleVoltage = 1,
  kTroubleSensor = 2,
  kTroubleHeat = 4,
  kTroubleOverload = 8,
};

struct ServoState {
  double steps = 0, speed = 0, duty = 0;  // duty -1..1
  double volts = NAN, celsius = NAN;      // NAN: not read this time
  std::uint8_t trouble = 0;               // ServoTrouble
};

class BusDriver {
 public:
  using Servo = servo_bus::BusServo;
  using Servos = std::span<const Servo* const>;
  struct Counts {
    std::uint64_t requests = 0, missing = 0, damaged = 0;
  };

  virtual ~BusDriver() = default;
  // `link` and `clock` must outlive it.
  static std::unique_ptr<BusDriver> make(servo_bus::Protocol protocol, Link& link, Clock& clock);

  struct Greeting {
    std::optional<int> model, mode;  // the servo's own numbers; nothing: not answered
  };
  // Makes a servo that is there ready to be driven. Nothing: it does not answer.
  virtual Result<std::optional<Greeting>> greet(const Servo& servo) = 0;
  // Of a model that has modes: the one that goes to positions.
  virtual int position_mode() const = 0;

  // One register, which the model must have. Nothing: it does not answer.
  virtual Result<std::optional<int>> read(const Servo& servo, std::string_view name) = 0;
  // So many bytes from the register `first` on.
  virtual Result<std::optional<std::vector<std::uint8_t>>> read_block(const Servo& servo,
                                                                      std::string_view first,
                                                                      std::size_t count) = 0;
  // False: not acknowledged, or refused.
  virtual Result<bool> write(const Servo& servo, std::string_view name, int value) = 0;

  // Nothing: it does not answer.
  virtual Result<std::vector<std::optional<ServoState>>> read_all(Servos servos) = 0;
  // Torque on, at this position. False: not acknowledged.
  virtual Result<bool> hold(const Servo& servo, double steps) = 0;
  virtual Result<void> release(const Servo& servo) = 0;
  struct Goal {
    const Servo* servo;
    double steps, speed;
  };
  // With as few requests as it takes; nobody answers them.
  virtual Result<void> move(std::span<const Goal> goals) = 0;
  // Lets servos whose protection acted be switched on again, at the positions that they have.
  virtual Result<void> recover(std::span<const Goal> troubled) = 0;

  virtual const Counts& counts() const = 0;
};

}  // namespace kaz::host
