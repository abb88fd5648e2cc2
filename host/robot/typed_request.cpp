// Error sentences for refusal codes and status flags: the joint, the reason, the remedy.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/typed_request.h"

#include <cstdio>
#include <numbers>

#include "host/link/frame_log.h"
#include "shared/protocol/message_info.h"

namespace kaz::host {

namespace {

std::string degrees(double rad) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", rad * 180 / std::numbers::pi);
  return text;
}

std::string joint_name(int joint) {
  return joint < KZ_JOINTS ? joint_table()[static_cast<std::size_t>(joint)].name
                           : "joint " + std::to_string(joint);
}

std::string range(double lower_rad, double upper_rad) {
  return degrees(lower_rad) + " to " + degrees(upper_rad) + " degrees";
}

std::string not_moved(int joint, std::span<const JointTarget> targets) {
  std::string text = joint_name(joint) + " was not moved: its target";
  for (const JointTarget& target : targets) {
    if (target.joint == joint) text += " of " + degrees(target.angle_rad) + " degrees";
  }
  return text + " lies outside ";
}

std::string outside_limits(int joint, std::span<const JointTarget> targets) {
  std::string text = not_moved(joint, targets) + "its limits";
  if (joint < KZ_JOINTS) {
    const JointInfo& info = joint_table()[static_cast<std::size_t>(joint)];
    text += " of " + range(info.lower_rad, info.upper_rad);
  }
  return text;
}

std::string out_of_range(const kz_refused& refusal) {
  if (refusal.request == KZ_TYPE_calibrate) {
    return "the calibration of " + joint_name(refusal.detail) +
           " is too far from nominal: the center may differ by at most 0.5 rad, "
           "and the scale by at most 25 %";
  }
  const kz_message_info* message = kz_message_find(refusal.request);
  if (!message || refusal.detail >= message->field_count) return "a value is out of range";
  return std::string("the field `") + message->fields[refusal.detail].name + "` is out of range";
}

}  // namespace

Error refusal_error(const kz_refused& refusal, std::span<const JointTarget> targets) {
  const std::string request = std::string("`") + message_name(refusal.request) + "`";
  switch (refusal.reason) {
    case KZ_REFUSED_UNKNOWN_TYPE:
      return {Fault::environment, "the board does not support the request " + request +
                                      ": its firmware is older than this program"};
    case KZ_REFUSED_LENGTH:
      return {Fault::environment, "the board refused " + request +
                                      ", because the request has the wrong length: "
                                      "firmware and program do not match"};
    case KZ_REFUSED_RANGE:
      return {Fault::failed, "the board refused " + request + ": " + out_of_range(refusal)};
    case KZ_REFUSED_LIMIT:
      return {Fault::failed, outside_limits(refusal.detail, targets)};
    case KZ_REFUSED_DISABLED:
      return {Fault::failed,
              joint_name(refusal.detail) +
                  " was not moved: its motor is off; enable the motor first, also after a fault"};
    case KZ_REFUSED_FAULT:
      return {shutdown_fault(static_cast<std::uint16_t>(refusal.detail << 8)),
              "the board refused " + request + ": " + kz_shutdown_text(refusal.detail) +
                  "; fix the cause, then clear the shutdown"};
    case KZ_REFUSED_BUSY:
      return {Fault::environment,
              "the board refused " + request + ": the board is still busy with earlier requests"};
    case KZ_REFUSED_ARMED:
      return {Fault::failed,
              "the board refused " + request + " while a motor is on: switch all joints off first"};
    case KZ_REFUSED_LOCKED:
      return {
          Fault::failed,
          "the board refused " + request +
              ": the request is only valid while the bench is unlocked; unlock the bench first"};
    case KZ_REFUSED_SHARED_LINE:
      return {Fault::failed, "the board refused " + request +
                                 ": a board sends no telemetry on a line that other boards share; "
                                 "query the board"};
    case KZ_REFUSED_STORE:
      return {Fault::environment, "the board refused " + request +
                                      ": its flash could not be written; the previous contents are "
                                      "still stored, and the chip may be worn out"};
    default:
      return {Fault::environment, "the board refused " + request + " for reason " +
                                      std::to_string(refusal.reason) +
                                      ", which is unknown to this program"};
  }
}

Error outside_set_limits(int joint, std::span<const JointTarget> targets, const Limits& set,
                         const std::string& recover) {
  const JointInfo& info = joint_table()[static_cast<std::size_t>(joint)];
  if (set.lower_rad <= info.lower_rad && set.upper_rad >= info.upper_rad)
    return {Fault::failed, outside_limits(joint, targets)};
  return {Fault::failed, not_moved(joint, targets) + "the limits set on the board, " +
                             range(set.lower_rad, set.upper_rad) + "; a reset of the board or `" +
                             recover + "` restores the joint's own limits, " +
                             range(info.lower_rad, info.upper_rad)};
}

namespace {

const char* remedy(std::uint8_t reason) {
  switch (reason) {
    case KZ_SHUTDOWN_STOP:
      return "find the cause of the stop, then enable the motors again";
    case KZ_SHUTDOWN_LINK_LOST:
      return "enable the motors again";
    case KZ_SHUTDOWN_POT:
      return "check the potentiometer's plug and cable";
    case KZ_SHUTDOWN_UNDERVOLTAGE:
      return "charge the battery, or use thicker supply wires";
    case KZ_SHUTDOWN_OVERVOLTAGE:
      return "use a supply of at most 12 V";
    case KZ_SHUTDOWN_TEMPERATURE:
      return "let the motor drivers cool";
    case KZ_SHUTDOWN_REFERENCE:
      return "check the analog inputs for a short";
    case KZ_SHUTDOWN_STALL:
      return "free the joint; if the joint's target is inside an obstacle, change the target";
    case KZ_SHUTDOWN_OVERLOAD:
      return "let the motor cool";
    default:
      return "see docs/explanation/safety.md";
  }
}

}  // namespace

Fault shutdown_fault(std::uint16_t status) {
  const int reason = status >> 8;
  return reason == KZ_SHUTDOWN_NONE || reason == KZ_SHUTDOWN_LINK_LOST ? Fault::environment
                                                                       : Fault::failed;
}

std::optional<std::string> fault_sentence(std::uint16_t status, const std::string& where) {
  std::string faults;
  const auto reason = static_cast<std::uint8_t>(status >> 8);
  if (reason != KZ_SHUTDOWN_NONE) {
    // On in spite of a shutdown: servos on a bus that do not confirm.
    faults = std::string(status & KZ_STATUS_HOLDING   ? "motors hold"
                         : status & KZ_STATUS_ENABLED ? "not all motors confirm that they are off"
                                                      : "motors went off") +
             ": " + kz_shutdown_text(reason) + (where.empty() ? "" : " (" + where + ")") + "; " +
             remedy(reason);
  }
  if (status & KZ_STATUS_MISSED_TICK) {
    faults += (faults.empty() ? "" : "; ") + std::string("a control cycle took longer than 1 ms");
  }
  if (faults.empty()) return std::nullopt;
  return "the board reports: " + faults;
}

}  // namespace kaz::host
