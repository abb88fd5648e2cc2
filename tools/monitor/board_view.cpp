// The monitor's lines.
// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/board_view.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <numbers>

#include "shared/base/one_line.hpp"

namespace kaz::tools {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kTickShare = 8.0 / KZ_STATES_PER_TICK;  // of a tick, in 8 states
constexpr double kTickBound = 0.75;                      // of a tick, docs/reference/firmware.md

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  char buffer[160];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

// The end of a long path, where paths of boards differ.
std::string tail(const std::string& path, std::size_t max_size) {
  return path.size() <= max_size ? path : "..." + path.substr(path.size() - max_size + 3);
}

// Without the sign of what rounds to nothing.
double tenth(double degrees) {
  return std::abs(degrees) < 0.05 ? 0 : degrees;
}

Line motors(const BoardView& view) {
  const std::uint16_t status = view.health.status;
  if (!view.there) return {{"no answer", Ink::bad}};
  if (status & KZ_STATUS_HOLDING) return {{"motors held: the link was lost", Ink::warning}};
  if ((status & host::kMotorsOffFaults) != 0 && (status & KZ_STATUS_ENABLED) != 0)
    return {{"shutdown, motors still on: cut the power", Ink::bad}};
  if ((status & host::kMotorsOffFaults) != 0) return {{"motors off: shutdown", Ink::bad}};
  if (status & KZ_STATUS_ENABLED) return {{"motors on", Ink::good}};
  return {{"motors off", Ink::plain}};
}

// A duty of -1..1 as a bar of 9 columns with zero in its middle.
std::string bar(double duty) {
  constexpr int kHalf = 4;
  std::string drawn(2 * kHalf + 1, ' ');
  drawn[kHalf] = '|';
  const int length = static_cast<int>(std::lround(std::min(1.0, std::abs(duty)) * kHalf));
  for (int i = 1; i <= length; ++i)
    drawn[static_cast<std::size_t>(kHalf + (duty < 0 ? -i : i))] = '=';
  return drawn;
}

Line joint_line(const BoardView& view, int joint, bool selected) {
  const auto at = static_cast<std::size_t>(joint);
  const char* name = view.names[at].c_str();
  const Ink base = selected ? Ink::selected : Ink::plain;
  if (at >= view.joints.size()) return {{text("%2d %-13s", joint, name), base}};
  const host::JointDetail& now = view.joints[at];
  const bool on = (now.flags & KZ_JOINT_ON) != 0;
  Line line;
  line.push_back({text("%2d %-13s", joint, name), base});
  const double target = view.targets[at] * kDegrees, angle = now.angle_rad * kDegrees;
  line.push_back(
      {on ? text("%8.1f %8.1f %7.1f ", tenth(target), tenth(angle), tenth(target - angle))
          : text("%8s %8.1f %7s ", "-", tenth(angle), "-"),
       Ink::plain});
  const double load = std::abs(now.load);
  line.push_back({text("%+5.0f %% %s", 100 * now.duty, bar(now.duty).c_str()), Ink::plain});
  line.push_back({text("%5.0f %% ", 100 * load),
                  load > 0.7 ? Ink::bad : (load > 0.4 ? Ink::warning : Ink::plain)});
  line.push_back(on ? Span{"on", Ink::good} : Span{"off", Ink::plain});
  if (now.flags & KZ_JOINT_MOVING) line.push_back({" moves", Ink::plain});
  if (now.flags & KZ_JOINT_POT) line.push_back({" POT", Ink::bad});
  if (now.flags & KZ_JOINT_STALLED) line.push_back({" STALLED", Ink::bad});
  if (now.flags & KZ_JOINT_HOT) line.push_back({" HOT", Ink::warning});
  if (now.flags & KZ_JOINT_AT_LIMIT) line.push_back({" limit", Ink::warning});
  return line;
}

// At most so many columns, a character each. Control characters, which a terminal would obey, are spelled
// out.
void cut(Line& line, int columns) {
  auto left = static_cast<std::size_t>(std::max(columns, 0));
  for (Span& span : line) {
    const std::string clean = one_line(span.text);
    std::size_t at = 0;
    for (; at < clean.size() && left > 0; --left)
      at += std::max<std::size_t>(1, utf8_length(clean, at));
    span.text = clean.substr(0, at);
  }
}

// Angle and state of a joint alone.
Line small_joint_line(const BoardView& view, int joint, bool selected) {
  const auto at = static_cast<std::size_t>(joint);
  Line line{
      {text("%2d %-13s", joint, view.names[at].c_str()), selected ? Ink::selected : Ink::plain}};
  if (at >= view.joints.size()) return line;
  const host::JointDetail& now = view.joints[at];
  const bool on = (now.flags & KZ_JOINT_ON) != 0;
  line.push_back({text("%8.1f ", tenth(now.angle_rad * kDegrees)), Ink::plain});
  line.push_back(on ? Span{"on", Ink::good} : Span{"off", Ink::plain});
  if (now.flags & KZ_JOINT_POT) line.push_back({" POT", Ink::bad});
  if (now.flags & KZ_JOINT_STALLED) line.push_back({" STALLED", Ink::bad});
  if (now.flags & KZ_JOINT_HOT) line.push_back({" HOT", Ink::warning});
  return line;
}

// In lines of so many columns, broken at spaces where there are some; `most` of them.
std::vector<std::string> wrapped(const std::string& sentence, int columns, std::size_t most) {
  std::string rest = one_line(sentence);
  std::vector<std::string> all;
  const auto width = static_cast<std::size_t>(std::max(columns, 1));
  while (all.size() + 1 < most && rest.size() > width) {
    const std::size_t space = rest.rfind(' ', width);
    if (space == std::string::npos || space == 0) break;
    all.push_back(rest.substr(0, space));
    rest.erase(0, space + 1);
  }
  all.push_back(rest);
  return all;
}

// The motors' state first: it must not be cut off.
std::vector<Line> small_lines(const BoardView& view, int selected, const std::string& said,
                              int rows, int columns) {
  if (rows < kMinLines || columns < kMinColumns)
    return {{{"window too small:", Ink::bold}},
            {{text("%d x %d, needs", columns, rows), Ink::plain}},
            {{text("%d x %d", kMinColumns, kMinLines), Ink::plain}}};
  std::vector<Line> all{motors(view)};
  all.front().push_back({"  " + tail(view.port, 36), Ink::bold});
  const bool board = rows >= 8;
  if (board)
    all.push_back(
        {{text("supply %.2f V  %.0f degC  missed %u", view.health.supply_volts,
               view.health.temperature_c, static_cast<unsigned>(view.counts.missed_ticks)),
          Ink::plain}});
  // Of what happened, all that leaves room for three joints.
  const auto words = wrapped(view.fault.empty() ? said : view.fault, columns,
                             static_cast<std::size_t>(std::max(1, rows - (board ? 6 : 5))));
  const int joints = static_cast<int>(view.names.size());
  const int shown = std::min(joints, rows - (board ? 3 : 2) - static_cast<int>(words.size()));
  const int first = std::clamp(selected - shown / 2, 0, joints - shown);
  for (int joint = first; joint < first + shown; ++joint)
    all.push_back(small_joint_line(view, joint, joint == selected));
  for (const std::string& line : words)
    all.push_back({{line, view.fault.empty() ? Ink::plain : Ink::bad}});
  all.push_back({{"q quit  SPACE stop  c clear  e on/off", Ink::bold}});
  return all;
}

std::vector<Line> large_lines(const BoardView& view, int selected, const std::string& said) {
  std::vector<Line> all;
  Line title{{text("kaz monitor  %s  ", tail(view.port, 36).c_str()), Ink::bold}};
  for (Span& span : motors(view)) title.push_back(std::move(span));
  all.push_back(std::move(title));

  const host::Health& h = view.health;
  const double busy = view.counts.busy_8states * kTickShare,
               worst = view.counts.worst_8states * kTickShare;
  all.push_back({{text("up %.0f s  supply %.2f V, lowest %.2f  %.0f degC  ", h.tick * 1e-3,
                       h.supply_volts, h.supply_lowest_volts, h.temperature_c),
                  Ink::plain},
                 {text("tick %.0f %%, worst %.0f %%", 100 * busy, 100 * worst),
                  worst > kTickBound ? Ink::bad : Ink::plain},
                 {text(", missed %u", static_cast<unsigned>(view.counts.missed_ticks)),
                  view.counts.missed_ticks > 0 ? Ink::bad : Ink::plain}});
  const host::LinkStatistics& l = view.link;
  const std::uint64_t lost = l.timeouts + l.bad_frames;
  all.push_back(
      {{text("link %.0f/s  reply %.1f ms (%.1f to %.1f)  ", view.rounds_per_s,
             1e3 * l.round_trip.smoothed_s, 1e3 * l.round_trip.min_s, 1e3 * l.round_trip.max_s),
        Ink::plain},
       {text("%llu requests, ", static_cast<unsigned long long>(l.requests)), Ink::plain},
       {text("%llu late, %llu damaged", static_cast<unsigned long long>(l.timeouts),
             static_cast<unsigned long long>(l.bad_frames)),
        lost > 0 ? Ink::warning : Ink::plain}});
  all.push_back(
      {{"   joint           target    angle   error     duty            load", Ink::bold}});
  for (int joint = 0; joint < static_cast<int>(view.names.size()); ++joint)
    all.push_back(joint_line(view, joint, joint == selected));
  if (!view.fault.empty())
    all.push_back({{view.fault, Ink::bad}});
  else
    all.push_back({{said, Ink::plain}});
  all.push_back(
      {{"up/down  e on/off  E all on  <- -> 1 deg  [ ] 5 deg  SPACE stop  c clear  q quit",
        Ink::bold}});
  return all;
}

}  // namespace

std::vector<std::string> kaz_joint_names() {
  std::vector<std::string> names;
  for (const host::JointInfo& info : host::joint_table()) names.emplace_back(info.name);
  return names;
}

std::vector<Line> lines(const BoardView& view, int selected, const std::string& said, int rows,
                        int columns) {
  std::vector<Line> all = rows < kLines || columns < kColumns
                              ? small_lines(view, selected, said, rows, columns)
                              : large_lines(view, selected, said);
  if (all.size() > static_cast<std::size_t>(std::max(rows, 0)))
    all.resize(static_cast<std::size_t>(std::max(rows, 0)));
  for (Line& line : all) cut(line, columns);
  return all;
}

}  // namespace kaz::tools
