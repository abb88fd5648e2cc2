// Data types of Robot: gains, limits, joint states, health, calibration. SI units.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "host/robot/posture.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

struct JointTarget {
  int joint;
  double angle_rad;
};

// duty = kp * error - kd * speed + friction * sign(error). If |error| is at most the dead band, the error
// counts as 0. The default gains are the gains of the board after a reset: kp 16 /rad (hands 0.8 /rad) and kd
// 0.09 s/rad.
struct Gains {
  double kp_per_rad = KZ_KP_DEFAULT / 256.0;     // duty per rad, 0..80
  double kd_s_per_rad = KZ_KD_DEFAULT / 4096.0;  // duty per rad/s, 0..1
  double dead_band_rad = 0;                      // 0..0.1
  double friction = 0;                           // duty, 0..0.25
};

// The board clips limits to the joint's mechanical range.
struct Limits {
  double ramp_rad_per_s = 6;  // maximum speed of the commanded angle, 0.1..12
  double lower_rad = -3.2767, upper_rad = 3.2767;
};

// Settings as stored on the board: values are rounded to the board's units, and limits are clipped to the
// joint's mechanical range.
struct JointSettings {
  Gains gains;
  Limits limits;
};

struct JointDetail {
  int joint = 0;
  double angle_rad = 0;
  double speed_rad_per_s = 0;  // smoothed over 8 ms
  double duty = 0;             // -1..1; a positive duty turns the joint in the positive direction
  double load = 0;             // estimated torque as a share of the stall torque
  std::uint8_t flags = 0;      // KZ_JOINT_*
};

struct Health {
  std::uint32_t tick = 0;
  std::uint16_t status = 0;  // KZ_STATUS_*, KZ_SHUTDOWN_* in the upper byte
  // Reason of a latched shutdown, in words; empty if no shutdown is latched.
  std::string shutdown;
  std::optional<int> joint;         // joint that caused the shutdown
  std::uint32_t shutdown_tick = 0;  // board time of the shutdown
  double supply_volts = 0, supply_lowest_volts = 0;
  double temperature_c = 0;  // temperature of the motor drivers
  // As a test, the A/D converter measures half of its own reference voltage. The result is a share of full
  // scale, nominally 0.5.
  double reference = 0;
};

// angle = center + scale * (code - 512) / 512
struct JointCalibration {
  double centre_rad = 0, scale_rad = 0;
};

struct Calibration {
  // KZ_CALIBRATION_*: the source from which the board loaded its calibration at start.
  std::uint8_t source = 0;
  std::uint16_t sequence = 0;  // number of the stored copy; 0: no calibration is stored
  // Erase cycles of the two flash blocks; each block is rated for 100.
  int erases_a = 0, erases_b = 0;
  std::array<JointCalibration, KZ_JOINTS> joints{};
};

struct StoredCalibration {
  std::uint16_t sequence = 0;
  int erases_a = 0, erases_b = 0;
};

struct SelfTest {
  std::uint8_t done = 0, failed = 0;  // KZ_TEST_*
  // Names of the failed tests, such as "RAM, FLASH"; empty if all passed.
  std::string failed_names;
  std::uint16_t image_crc = 0;
  double start_s = 0;  // time from the start of the application to the first tick
};

// One telemetry frame. Each kind of frame sets only some of the members; the other members are 0 or empty.
struct TelemetryFrame {
  std::uint8_t selection = 0;  // KZ_TELEMETRY_*: the kind of frame
  std::uint32_t tick = 0;      // board time
  Time time{};                 // host time that corresponds to `tick`
  std::uint16_t status = 0;
  // Angles (rad) in STATE and COMMANDS frames; duties (-1..1) in DRIVES frames.
  JointAngles values{};
  double supply_volts = 0;   // in STATE and HEALTH frames
  std::optional<int> joint;  // in HEALTH frames: joint that caused the shutdown
  double temperature_c = 0;  // in HEALTH frames
  // In HEALTH frames: computation time of the last tick (`tick_busy`) and of the longest tick (`tick_worst`).
  // Both are shares of a tick's duration.
  double tick_busy = 0, tick_worst = 0;
};

// Reaction of the link watchdog when it expires.
enum class Reaction : std::uint8_t { limp = KZ_REACTION_LIMP, hold = KZ_REACTION_HOLD };
inline constexpr std::array kReactions{Reaction::hold, Reaction::limp};

constexpr const char* to_string(Reaction reaction) {
  return reaction == Reaction::hold ? "hold" : "limp";
}

// A reconnection after the link was lost.
struct Resumption {
  enum class Cause : std::uint8_t {
    link,      // the port disappeared, or no reply came
    watchdog,  // the board's link watchdog expired before the next request
    reset,     // the board was restarted
  };
  Cause cause = Cause::link;
  Time lost{};            // time at which the loss was detected
  Time resumed{};         // time at which requests were answered again
  bool reported = false;  // true: ConnectOptions::on_lost, if set, was called
};

// Description of a lost link; the argument of ConnectOptions::on_lost.
struct Loss {
  Resumption::Cause cause = Resumption::Cause::link;
  Time at{};        // time at which the loss was detected
  Time at_most{};   // time limit of the search, as in ConnectOptions::reconnect
  std::string why;  // error message of the link or the board
};

// Text before the address that a user should choose, in errors of commands with the option --address.
inline constexpr const char* kAddressAdvice = "give --address ";

struct ConnectOptions {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  int retries = 5;  // maximum number of times that a request without a reply is sent again
  // Time limit of the board's link watchdog, 10 ms..1 s; zero leaves limit and reaction unchanged. With a
  // limit of 90 ms, the board reacts within 100 ms after the last request that it received.
  Time watchdog = std::chrono::milliseconds(90);
  Reaction reaction = Reaction::hold;
  // Time limit of reconnection. Zero: there is no reconnection, and a lost link is an error at once.
  Time reconnect = std::chrono::seconds(3);
  // Called at most once for each lost link: when a request fails, or when the first attempt to reconnect
  // fails. Not called if only the board's watchdog expired and the board still answers.
  std::function<void(const Loss&)> on_lost = {};
  // Called after each reconnection, in addition to Robot::take_resumption().
  std::function<void(const Resumption&)> on_resumed = {};
  // Path of a file that gets the last 64 frames after a permanent link failure, or "-" for standard error.
  // The error message names the file. Empty: the frames are not written (see Robot::recent_frames).
  std::string frames_path = {};
  // Joint names for messages, indexed by joint number; empty: the names of Kaz's joints.
  std::vector<std::string> joint_names = {};
  // Speed limits of the joints, rad/s, indexed by joint number; empty: no limits. connect() lowers the
  // board's ramps to these limits, and Robot::set_limits() refuses faster ramps.
  std::vector<double> max_rad_per_s = {};
  // Advice of the error if no board answers at its address, but another board does: the text before the
  // found address.
  std::string address_advice = kAddressAdvice;
};

// One of the boards that drive a robot together.
struct RobotBoard {
  Link* link = nullptr;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  std::uint32_t joints = 0;  // mask of the joints that this board drives
};

// Checks that each board has a joint, and that each joint is on exactly one board. Otherwise fails (usage);
// the error message names the joints.
Result<void> check_boards(std::span<const RobotBoard> boards);

// Returns the cause as text, such as "the board was reset".
const char* text(Resumption::Cause cause);

}  // namespace kaz::host
