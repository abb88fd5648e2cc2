// State of a board as the monitor displays it, and its text lines.
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
  bool there = false;  // the last query was answered
  host::Health health;
  kz_statistics_reply counts{};
  host::LinkStatistics link;
  std::vector<host::JointDetail> joints;  // all joints by number; empty before the first reading
  host::JointAngles targets{};            // rad; for a joint that is off, its angle
  std::string fault;                      // Robot::describe_fault, or why the board does not reply
  double rounds_per_s = 0;
};

// Style of a text.
enum class Ink { plain, bold, good, warning, bad, selected };

struct Span {
  std::string text;
  Ink ink = Ink::plain;
};
using Line = std::vector<Span>;

// Returns at most `rows` lines of at most `columns` columns. At 24 x 80 they are: title, board, link, head of
// the table, one line for each of 18 joints, last message, keys. Angles are in degrees, as on a protractor at
// the joint. A smaller window has: motors, joints around the selected one, last message, keys. Below
// kMinLines x kMinColumns only a note that it is too small.
inline constexpr int kLines = 24, kColumns = 80;
inline constexpr int kMinLines = 5, kMinColumns = 28;
std::vector<Line> lines(const BoardView& view, int selected, const std::string& said,
                        int rows = kLines, int columns = kColumns);

}  // namespace kaz::tools
