// Joint numbers and names, and the angles of all joints at one time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "host/robot/inertial.h"
#include "shared/base/time.hpp"
#include "shared/board/board.h"

namespace kaz::host {

// Joint names and limits (rad), from shared/board/joints.def and shared/robot/kaz/kaz.urdf.
struct JointInfo {
  const char* name;
  double lower_rad, upper_rad;
};
std::span<const JointInfo, KZ_JOINTS> joint_table();
std::optional<int> joint_index(std::string_view name);

// Joint numbers by name: neck_pan, neck_tilt, ...
enum Joint : int {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) name = index,
#include "shared/board/joints.def"
#undef KZ_JOINT
};

inline constexpr std::uint32_t kAllJoints = (std::uint32_t{1} << KZ_JOINTS) - 1;

using JointAngles = std::array<double, KZ_JOINTS>;  // rad

struct Posture {
  Time time{};               // host time of the measurement
  std::uint32_t tick = 0;    // board time, ms
  JointAngles angle{};       // rad, as measured by the potentiometers
  std::uint16_t status = 0;  // KZ_STATUS_*
  double supply_volts = 0;
  std::optional<Inertial> inertial = {};  // set only after Robot::sense_inertial()
};

}  // namespace kaz::host
