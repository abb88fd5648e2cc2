// Texts of the events of the host.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/host_watch.h"

#include <cstdio>

namespace kaz::sim {
namespace {

std::string milliseconds(Time t) {
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(t).count()) + " ms";
}

}  // namespace

void HostWatch::say(const std::string& text) {
  if (report_) report_(text);
}

void HostWatch::presence(Time now, bool present, long baud) {
  if (present != present_) {
    present_ = present;
    if (present) {
      say("host opened " + port_);
      heard_ = silent_ = losing_ = false;
      baud_ = 115200;
    } else {
      say("host closed " + port_ +
          (heard_ ? ", " + milliseconds(now - last_byte_) + " after its last byte" : ""));
    }
  }
  if (present && baud != baud_) {
    baud_ = baud;
    if (baud != 115200)
      say("host set " + port_ + " to " +
          (baud == 0 ? "an invalid bit rate" : std::to_string(baud) + " baud") +
          "; the firmware uses 115200 baud and receives damaged bytes; boot mode uses 9600 baud");
  }
}

void HostWatch::bytes_came(Time now) {
  if (silent_) say("host sends again");
  heard_ = true;
  silent_ = held_ = false;
  last_byte_ = now;
}

void HostWatch::bytes_lost(std::size_t count) {
  if (!losing_)
    say("host does not read " + port_ + ": " + std::to_string(count) +
        " bytes from the board lost");
  losing_ = true;
}

void HostWatch::check_silence(Time now) {
  if (!present_ || !heard_ || silent_ || now - last_byte_ < kSilence) return;
  silent_ = true;
  say("host silent for " + milliseconds(now - last_byte_));
}

void HostWatch::drivers(Time now, bool enabled, const std::string& why) {
  if (enabled == enabled_) return;
  enabled_ = enabled;
  if (enabled) {
    say("motors on");
    return;
  }
  std::string text = "motors off";
  if (!why.empty()) {
    char at[40];
    std::snprintf(at, sizeof at, " at %.3f s: ", seconds(now));
    text += at + why;
  }
  if (heard_) text += ", " + milliseconds(now - last_byte_) + " after the host's last byte";
  say(text);
}

void HostWatch::held(Time now) {
  held_ = true;
  char text[120];
  std::snprintf(
      text, sizeof text,
      "at %.3f s, %s after the host's last byte, the link watchdog began to hold the joints",
      seconds(now), milliseconds(now - last_byte_).c_str());
  say(text);
}

void HostWatch::board_restarted(const std::string& why) {
  say("board restarted: " + why);
}

}  // namespace kaz::sim
