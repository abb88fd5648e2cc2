// A bus of servos as a servo board: answers the protocol's requests by asking the servos.
// SPDX-License-Identifier: Apache-2.0
//
// So Robot, and all that stands on it, drives robots of bus servos unchanged. What is the servos' own differs
// from the firmware's board (docs/howto/servo-bus.md): the position loop and its gains, protection against
// overload, and what happens when the host goes away, which is that they hold. Telemetry, calibration, raw
// drive and the loader are refused.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/bus/bus_driver.h"
#include "shared/board/board.h"
#include "shared/protocol/frame.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

// A joint of the robot, in the order of its board's numbers.
struct BusJoint {
  servo_bus::BusServo servo;
  double lower_rad = 0, upper_rad = 0;  // of its mechanics
};

class BusBoard {
 public:
  static constexpr double kMaxSpeed = 12;  // rad/s, of limits

  // Asks each servo whether it is there, and is of its model and in position mode. `clock` is the link's.
  // Errors (environment): one does not answer, with all that do not; (usage): another model or mode, more
  // joints than a board has, an id twice, servos of two protocols.
  static Result<BusBoard> open(Link& link, Clock& clock, std::vector<BusJoint> joints);

  // Bytes of the host's. Frames among them wait for serve(), in order. A `stop`, or an `enable` with an empty
  // mask, waits for nothing: earlier requests are discarded, and the host repeats those that it still needs.
  void take(std::span<const std::uint8_t> bytes);
  // Whether the next serve() switches all motors off.
  bool off_is_next() const { return !waiting_.empty() && switches_all_off(waiting_.front()); }
  // Answers one frame that waits: the bytes of the answer, none for a frame of another board; nothing if none
  // waits. Errors: the port's.
  Result<std::optional<std::vector<std::uint8_t>>> serve();
  const BusDriver::Counts& counts() const { return driver_->counts(); }
  // Servos that have not said that they are off, as still_on() of bus_driver.h.
  std::string still_on() const;
  // The port was opened anew.
  void forget();

 private:
  // Unconfirmed: it should be off, and its servo has not said so. It takes no targets, and counts as on.
  enum class Power : std::uint8_t { off, on, unconfirmed };
  struct Joint {
    BusJoint of;
    Power power = Power::unconfirmed;
    BusDriver::Torque said = BusDriver::Torque::silent;  // when it was last asked to be off
    bool accepted = true;                                // what the last recover() wrote
    int missing = 0;                                     // readings in a row that did not come
    double angle = 0, speed = 0, duty = 0, target = 0;   // rad, rad/s, -1..1, rad
    std::uint8_t trouble = 0;                            // ServoTrouble
    s16 lower = 0, upper = 0;                            // 100 urad, soft limits
    u16 ramp = 60;                                       // 100 urad/ms
    u16 kp = KZ_KP_DEFAULT, kd = KZ_KD_DEFAULT, dead_band = 0;
    u8 friction = 0;
  };
  using Fields = std::vector<std::uint8_t>;
  struct Refusal {
    u8 reason = 0, detail = KZ_NO_DETAIL;
  };

  BusBoard(std::unique_ptr<BusDriver> driver, Clock& clock)
      : driver_(std::move(driver)), clock_(clock) {
    kz_receiver_init(&receiver_);
    start_ = clock.now();
  }
  Result<void> look();  // reads all servos, unless that was just done
  Result<void> switch_to(std::uint32_t mask);
  // Asks these to be off, and takes what they say; up to BusDriver::kReleaseWithin.
  Result<void> release(std::vector<Joint*> joints, Time within = BusDriver::kReleaseWithin);
  // One of those that are unconfirmed, once: within a control cycle.
  Result<void> release_next();
  Result<void> shut_down(u8 reason, u8 detail);
  u8 cause(u8& detail) const;  // KZ_SHUTDOWN_* that is there now
  Result<Fields> answer(u8 type, const u8* body, u8 size, Refusal& refusal);
  Result<void> move(const kz_targets& targets);
  Result<void> reset();
  void set_limits(const kz_limits& limits);
  // Of servos whose protection acted.
  Result<void> recover();
  std::uint32_t on() const;      // joints that are not confirmed to be off
  std::uint32_t driven() const;  // joints that take targets
  std::uint32_t there() const;   // joints that have a servo
  std::uint32_t tick() const;
  u16 status() const;
  std::vector<const servo_bus::BusServo*> servos() const;

  std::unique_ptr<BusDriver> driver_;
  Clock& clock_;
  std::vector<Joint> joints_;
  kz_receiver receiver_{};
  static bool switches_all_off(const std::vector<std::uint8_t>& body);
  std::vector<std::vector<std::uint8_t>> waiting_;  // bodies of frames
  std::vector<std::uint8_t> last_body_, last_answer_;
  Time start_{}, moving_until_{}, looked_{}, silent_due_{};
  std::size_t released_ = 0;  // the joint that release_next() took last
  bool has_looked_ = false;
  u8 reason_ = 0, detail_ = KZ_NO_DETAIL;
  std::uint32_t shutdown_tick_ = 0;
  u8 watchdog_10ms_ = 50, reaction_ = KZ_REACTION_HOLD;
  double volts_ = 0, lowest_volts_ = 0, celsius_ = 0;
  u16 frames_ = 0, refusals_ = 0, bad_frames_ = 0;
};

}  // namespace kaz::host
