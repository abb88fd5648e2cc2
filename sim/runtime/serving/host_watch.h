// Reports events of the host on the serial line (connected, silent, gone) and of the motors, as text.
// SPDX-License-Identifier: Apache-2.0
//
// Simulated time.
#pragma once

#include <functional>
#include <string>

#include "vision/image/frame.h"  // Time

namespace kaz::sim {

class HostWatch {
 public:
  static constexpr Time silence = std::chrono::milliseconds(1000);
  static constexpr Time shortest_watchdog =
      std::chrono::milliseconds(10);  // docs/reference/protocol.md

  HostWatch(std::string port, std::function<void(const std::string&)> report)
      : port_(std::move(port)), report_(std::move(report)) {}

  // To be called in each step, with ascending times.
  void presence(Time now, bool present, long baud);
  void bytes_came(Time now);
  void bytes_lost(std::size_t count);  // the host did not read what the board sent
  // `why`: why they are off, a few words; "" where it is not known.
  void drivers(Time now, bool enabled, const std::string& why = "");
  // The board's link watchdog has expired, and its joints hold where they are.
  void held(Time now);
  // Whether that can be: not reported yet since the host's last byte, and long enough after it.
  bool may_hold(Time now) const {
    return heard_ && !held_ && now - last_byte_ >= shortest_watchdog;
  }
  void board_restarted(const std::string& why);
  void check_silence(Time now);

  bool present() const { return present_; }

 private:
  void say(const std::string& text);

  std::string port_;
  std::function<void(const std::string&)> report_;
  bool present_ = false, heard_ = false, silent_ = false, enabled_ = false, losing_ = false,
       held_ = false;
  long baud_ = 115200;
  Time last_byte_{};
};

}  // namespace kaz::sim
