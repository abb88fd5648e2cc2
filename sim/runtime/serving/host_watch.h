// Reports events as text, such as: the host opens the port; the host is silent; the motors are switched off.
// SPDX-License-Identifier: Apache-2.0
//
// All times are in simulated time.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "shared/base/time.hpp"

namespace kaz::sim {

class HostWatch {
 public:
  static constexpr Time kSilence = std::chrono::milliseconds(1000);
  // Minimum timeout of the link watchdog (docs/reference/protocol.md).
  static constexpr Time kShortestWatchdog = std::chrono::milliseconds(10);

  HostWatch(std::string port, std::function<void(const std::string&)> report)
      : port_(std::move(port)), report_(std::move(report)) {}

  // Call this function in each step, with ascending times. `baud` is the bit rate that the host has set, or 0
  // if the rate is unsupported.
  void presence(Time now, bool present, long baud);
  // Call this function if the host has sent bytes.
  void bytes_came(Time now);
  // Call this function if `count` bytes from the board were lost because the host does not read.
  void bytes_lost(std::size_t count);
  // Call this function in each step. `why` states in a few words why the motor drivers are off. If `why` is
  // empty, the reason is unknown.
  void drivers(Time now, bool enabled, const std::string& why = "");
  // Call this function if the board's link watchdog has expired and the joints hold their positions.
  void held(Time now);
  // Returns true if the host has been silent for at least kShortestWatchdog, and held() has not been called
  // during this silence. If the result is true, the link watchdog may have expired.
  bool may_hold(Time now) const {
    return heard_ && !held_ && now - last_byte_ >= kShortestWatchdog;
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
