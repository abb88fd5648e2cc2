// What the monitor shows of a board, and its lines on the screen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/robot/robot.h"

namespace kaz::tools {

// Kaz's, in the order of their numbers.
std::vector<std::string> kaz_joint_names();

struct BoardView {
  std::string port;
  std::vector<std::string> names = kaz_joint_names();  // of the joints that are shown; at least one
  std::string build;                                   // identity
  bool there = false;                                  // the last round was answered
  host::Health health;
  kz_statistics_reply counts{};
  host::LinkStatistics link;
  std::vector<host::JointDetail> joints;  // all, by number; empty: none were read yet
  host::JointAngles targets{};            // rad; of a joint that is off, its angle
  std::string fault;                      // Robot::describe_fault, or why nothing is heard
  double rounds_per_s = 0;
};

// How a line is to look.
enum class Ink { plain, bold, good, warning, bad, selected };

struct Span {
  std::string text;
  Ink ink = Ink::plain;
};
using Line = std::vector<Span>;

// At most `rows` lines of at most `columns` columns. With 24 x 80: title, board, link, head of the table, a
// line a joint of 18, what was said last, keys. Angles in degrees, as on a protractor beside the joint. In a
// smaller window: motors, joints around the selected one, what was said last, keys. Below kMinLines x
// kMinColumns: that it is too small.
inline constexpr int kLines = 24, kColumns = 80;
inline constexpr int kMinLines = 5, kMinColumns = 28;
std::vector<Line> lines(const BoardView& view, int selected, const std::string& said,
                        int rows = kLines, int columns = kColumns);

}  // namespace kaz::tools
