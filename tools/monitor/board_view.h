// State of a board as displayed by the monitor, and the text lines that display the state.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/robot/robot.h"

namespace kaz::tools {

// Returns Kaz's joint names in the order of their numbers.
std::vector<std::string> kaz_joint_names();

struct BoardView {
  std::string port;
  // Names of the displayed joints; at least one.
  std::vector<std::string> names = kaz_joint_names();
  std::string build;   // build of the firmware
  bool there = false;  // true: the board replied to the last query
  host::Health health;
  kz_statistics_reply counts{};
  host::LinkStatistics link;
  // State of every joint, by joint number; empty before the first reading.
  std::vector<host::JointDetail> joints;
  host::JointAngles targets{};  // rad; for a joint that is off: its present angle
  // Text of Robot::describe_fault(), or the reason why the board does not reply.
  std::string fault;
  double rounds_per_s = 0;
};

// Style of a text.
enum class Ink { plain, bold, good, warning, bad, selected };

struct Span {
  std::string text;
  Ink ink = Ink::plain;
};
using Line = std::vector<Span>;

// Returns at most `rows` lines of at most `columns` columns. A window of 24 x 80 shows title, board, link,
// head of the table, one line for each of 18 joints, last message and keys. Angles are in degrees, as on a
// protractor at the joint. A smaller window has these lines: motors, joints around the selected joint, last
// message, keys. A window smaller than kMinLines x kMinColumns shows only a note that the window is too
// small.
inline constexpr int kLines = 24, kColumns = 80;
inline constexpr int kMinLines = 5, kMinColumns = 28;
std::vector<Line> lines(const BoardView& view, int selected, const std::string& said,
                        int rows = kLines, int columns = kColumns);

}  // namespace kaz::tools
