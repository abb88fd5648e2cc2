// Interface to servos on a bus, independent of their protocol.
// SPDX-License-Identifier: Apache-2.0
//
// Positions are in steps of a servo's sensor, speeds in steps/s. A request without an answer is sent once
// more. If no servo answers the second request either, the result is empty, and the statistics count a
// missing answer. All errors that the functions return are errors of the port.
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

// Returns a name for messages, such as "servo 1 (pan)".
std::string named(const servo_bus::BusServo& servo);
// Returns the command-line option that selects a bus, such as "--robot feetech:/dev/ttyACM0". Messages that
// suggest a command contain this option.
std::string bus_option(servo_bus::Protocol protocol, const std::string& port_name);

// Bits for the faults that a servo reports.
enum ServoTrouble : std::uint8_t {
  kTroubleVoltage = 1,
  kTroubleSensor = 2,
  kTroubleHeat = 4,
  kTroubleOverload = 8,
};

struct ServoState {
  double steps = 0, speed = 0, duty = 0;  // duty -1..1
  double volts = NAN, celsius = NAN;      // NAN: not included in this reading
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
  // `link` and `clock` must outlive the driver.
  static std::unique_ptr<BusDriver> make(servo_bus::Protocol protocol, Link& link, Clock& clock);

  struct Greeting {
    std::optional<int> model, mode;  // numbers as reported by the servo; empty: no answer
    // Name of a register whose write the servo rejected; empty: the servo accepted all writes.
    std::string_view refused = {};
  };
  // Reads model and mode, and prepares the servo for targets. Returns nullopt if the servo does not answer.
  virtual Result<std::optional<Greeting>> greet(const Servo& servo) = 0;
  // Number of the position mode, for models that have modes.
  virtual int position_mode() const = 0;

  // Reads one register, which the model must have. Returns nullopt if the servo does not answer.
  virtual Result<std::optional<int>> read(const Servo& servo, std::string_view name) = 0;
  // Reads `count` bytes, beginning at the register `first`. Returns nullopt if the servo does not answer.
  virtual Result<std::optional<std::vector<std::uint8_t>>> read_block(const Servo& servo,
                                                                      std::string_view first,
                                                                      std::size_t count) = 0;
  // Writes one register. Returns false if the servo rejects the value or does not acknowledge.
  virtual Result<bool> write(const Servo& servo, std::string_view name, int value) = 0;
  // Writes one register of all servos in one packet, which no servo answers.
  virtual Result<void> write_all(Servos servos, std::string_view name, int value) = 0;
  // Writes one register, with at most two tries. A try succeeds if the servo acknowledges the write, or if a
  // read after the write returns `value`. Returns false if both tries fail.
  Result<bool> set(const Servo& servo, std::string_view name, int value);

  // Reads the state of all servos. The state of a servo that does not answer is empty.
  virtual Result<std::vector<std::optional<ServoState>>> read_all(Servos servos) = 0;
  // Switches torque on with the position `steps` as goal, but only if the servo accepts this goal. Returns
  // false if the servo rejects the goal or does not confirm that torque is on. If hold() returns false, call
  // release(). Reason: on some servos, the goal alone switches the torque on.
  Result<bool> hold(const Servo& servo, double steps);
  // Torque state in a servo's answer. `silent`: no answer, or an answer without a value.
  enum class Torque : std::uint8_t { off, on, silent };
  static constexpr Time kReleaseWithin = std::chrono::milliseconds(150);
  // Switches torque off with one packet to all servos. Then reads the torque state of each servo, at most
  // three times, until the state is `off`. Before the second and the third reading, writes the servo's torque
  // register again. Returns early once the time `within` has passed, but always reads the first servo's state
  // once.
  Result<std::vector<Torque>> release(Servos servos, Time within = kReleaseWithin);
  struct Goal {
    const Servo* servo;
    double steps, speed;
  };
  // Sends goals in as few requests as possible; servos do not answer these requests.
  virtual Result<void> move(std::span<const Goal> goals) = 0;
  // Prepares servos that were stopped by an internal protection, such as the overload protection. After this
  // call, the servos can be switched on again at their present positions. Returns for each servo whether the
  // servo accepted the recovery. After this call, the torque of the servos may be on, so call release().
  virtual Result<std::vector<bool>> recover(std::span<const Goal> troubled) = 0;

  virtual const Counts& counts() const = 0;

 protected:
  Clock& clock_;
};

// Returns a message that lists the servos whose torque may still be on, and names the remedy. The message is
// empty if all servos have confirmed that their torque is off. `torque` has one entry per servo. Example:
// "pan (id 1) still has torque; lift (id 2) does not confirm that its torque is off: cut the power".
std::string still_on(BusDriver::Servos servos, std::span<const BusDriver::Torque> torque);

}  // namespace kaz::host
