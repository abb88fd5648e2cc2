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
#include <string>
#include <string_view>
#include <vector>

#include "host/link/link.h"
#include "shared/servo_bus/bus_file.h"

namespace kaz::host {

// "servo 1 (pan)"
std::string named(const servo_bus::BusServo& servo);
// "--robot feetech:/dev/ttyACM0": for commands that a message suggests.
std::string bus_option(servo_bus::Protocol protocol, const std::string& port_name);

// Faults that a servo reports.
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
  explicit BusDriver(Clock& clock) : clock_(clock) {}
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
    std::string_view refused = {};   // a register that the servo did not accept; empty: none
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
  // One register of all servos, in one packet; nobody answers it.
  virtual Result<void> write_all(Servos servos, std::string_view name, int value) = 0;
  // Writes until the servo accepts: acknowledges, or has the value when it is read back. False: it does not.
  Result<bool> set(const Servo& servo, std::string_view name, int value);

  // Nothing: it does not answer.
  virtual Result<std::vector<std::optional<ServoState>>> read_all(Servos servos) = 0;
  // Torque on, at this position, but only where the servo accepts the goal. False: it does not, or does not
  // confirm its torque; the torque may then be on (a goal may switch it on), so release() the servo.
  Result<bool> hold(const Servo& servo, double steps);
  // A servo's answer about its torque; silent: no answer, or one without a value.
  enum class Torque : std::uint8_t { off, on, silent };
  static constexpr Time kReleaseWithin = std::chrono::milliseconds(150);
  // Torque off: one packet to all, then each servo is read back and written to again until it says `off`.
  // Ends after three rounds, or with the first servo whose turn begins after `within`; the first servo is
  // always read back.
  Result<std::vector<Torque>> release(Servos servos, Time within = kReleaseWithin);
  struct Goal {
    const Servo* servo;
    double steps, speed;
  };
  // With as few requests as it takes; nobody answers them.
  virtual Result<void> move(std::span<const Goal> goals) = 0;
  // Lets servos whose protection acted be switched on again, at the positions that they have. For each:
  // whether it accepted that. Their torque may be on: release() them.
  virtual Result<std::vector<bool>> recover(std::span<const Goal> troubled) = 0;

  virtual const Counts& counts() const = 0;

 protected:
  Clock& clock_;
};

// Servos that should be off and do not say so, a sentence with what to do: "pan (id 1) still has torque;
// lift (id 2) does not confirm that its torque is off: cut the power". Empty: all said that they are off.
// One of `torque` for each of `servos`.
std::string still_on(BusDriver::Servos servos, std::span<const BusDriver::Torque> torque);

}  // namespace kaz::host
