// Emulates a servo board with the servos of a bus: answers protocol requests and sends commands to the
// servos.
// SPDX-License-Identifier: Apache-2.0
//
// Through this class, Robot and all code above Robot drive bus servos without changes. BusBoard differs from
// a board with firmware in some points (docs/howto/own-arm.md). The servos contain the position loop, the
// gains and the overload protection. If the host disappears, the servos hold their positions. Requests for
// telemetry, raw drive or the loader, and requests that write calibration or address, are refused.
#pragma once

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

// A joint of the robot. In BusBoard::open(), the index of a joint in the vector is the joint's number.
struct BusJoint {
  servo_bus::BusServo servo;
  double lower_rad = 0, upper_rad = 0;  // mechanical range
  double max_rad_per_s = 6;             // maximum speed of the goal, above 0
};

class BusBoard {
 public:
  // Checks that each servo answers, has the configured model and is in position mode. `clock` must be the
  // clock of the link; both must outlive the board. Fails (environment) if a servo does not answer or rejects
  // a setting, or if a joint is more than 15 degrees outside its range. If servos do not answer, the message
  // lists all of them. Fails (usage) if a servo has the wrong model or mode, or if two servos have the same
  // id or different protocols. Also fails (usage) if `joints` is empty or has more than KZ_JOINTS elements.
  // Also fails (usage) if a joint's range includes angles for which its servo has no positions.
  static Result<BusBoard> open(Link& link, Clock& clock, std::vector<BusJoint> joints);

  // Parses bytes from the host and queues the frames for serve(). A `stop`, or an `enable` with an empty
  // mask, discards earlier requests, so that motors are switched off without delay. The host repeats
  // discarded requests that it still needs.
  void take(std::span<const std::uint8_t> bytes);
  // Returns whether the next call of serve() switches all motors off.
  bool off_is_next() const { return !waiting_.empty() && switches_all_off(waiting_.front()); }
  // Executes the oldest queued frame. Returns the bytes of the reply, which are empty for a frame without a
  // reply; nullopt if no frame was queued. Returns the errors of the port.
  Result<std::optional<std::vector<std::uint8_t>>> serve();
  const BusDriver::Counts& counts() const { return driver_->counts(); }
  // Returns the message of host::still_on() (bus_driver.h) about this board's servos.
  std::string still_on() const;
  // Discards partial and queued frames after the port was reopened.
  void forget();

 private:
  // `unconfirmed`: the torque should be off, but the servo has not confirmed that the torque is off. An
  // unconfirmed joint takes no targets and counts as on.
  enum class Power : std::uint8_t { off, on, unconfirmed };
  struct Joint {
    BusJoint of;
    Power power = Power::unconfirmed;
    BusDriver::Torque said = BusDriver::Torque::silent;  // reply to the last torque-off request
    bool accepted = true;  // whether the servo accepted the last recover()
    int missing = 0;       // consecutive readings without a reply
    // `angle` and `target` in rad, `speed` in rad/s, `duty` from -1 to 1.
    double angle = 0, speed = 0, duty = 0, target = 0;
    std::uint8_t trouble = 0;  // ServoTrouble
    s16 lower = 0, upper = 0;  // soft limits, unit 100 urad
    u16 ramp = 60;             // unit 100 urad/ms
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
  Result<void> look();  // reads the state of all servos if the last reading is too old
  Result<void> switch_to(std::uint32_t mask);
  // Switches the joints' torque off and records the replies; see BusDriver::release.
  Result<void> release(std::vector<Joint*> joints, Time within = BusDriver::kReleaseWithin);
  // Tries once to release the next unconfirmed joint. The call is short enough for a control cycle.
  Result<void> release_next();
  Result<void> shut_down(u8 reason, u8 detail);
  u8 cause(u8& detail) const;  // present cause of a shutdown, KZ_SHUTDOWN_*; 0: none
  // Executes a request. Returns the fields of the reply, or sets `refusal`.
  Result<Fields> answer(u8 type, const u8* body, u8 size, Refusal& refusal);
  Result<Fields> enable(std::uint32_t mask, Refusal& refusal);
  // Clears the cause of the shutdown after the servos have recovered.
  Result<Fields> clear(Refusal& refusal);
  // If there is a cause of a shutdown, shuts down and returns the refusal. Otherwise its reason is 0.
  Result<Refusal> refuse_for_cause();
  Refusal check(const kz_targets& targets) const;
  Fields health_reply() const;
  Fields statistics_reply() const;
  Fields read_targets_reply(std::uint32_t mask) const;
  Fields state_reply() const;
  Fields joints_reply(std::uint32_t mask) const;
  Fields settings_reply(u8 joint) const;
  Fields acknowledge() const;
  Result<void> move(const kz_targets& targets);
  Result<void> reset();
  void set_gains(const kz_gains& gains);
  void set_limits(const kz_limits& limits);
  // Recovers servos that were stopped by an internal protection, such as the overload protection.
  Result<void> recover();
  std::uint32_t on() const;      // mask of the joints whose torque is not confirmed to be off
  std::uint32_t driven() const;  // mask of the joints that accept targets
  std::uint32_t there() const;   // mask of the joints that have a servo
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
  std::size_t released_ = 0;  // number of the joint that release_next() tried last
  bool has_looked_ = false;
  u8 reason_ = 0, detail_ = KZ_NO_DETAIL;
  std::uint32_t shutdown_tick_ = 0;
  u8 watchdog_10ms_ = 50, reaction_ = KZ_REACTION_HOLD;
  double volts_ = 0, lowest_volts_ = 0, celsius_ = 0;
  u16 frames_ = 0, refusals_ = 0, bad_frames_ = 0;
};

}  // namespace kaz::host
