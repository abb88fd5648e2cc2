// Selects the moments of a run at which pictures are taken.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace kaz::tools {

// catch-ball has five moments: searching, tracking, approaching, the hand at the ball, the ball held. Other
// behaviors with a phase `track` have four, spread evenly over the expected time. Times are seconds of the
// robot since the start.
class Moments {
 public:
  explicit Moments(double expected_s) : expected_s_(expected_s) {}
  Moments(const Moments&) = delete;
  Moments& operator=(const Moments&) = delete;

  // Returns the name of the moment if a picture is due, else nullopt. Moments of tracking have an empty name.
  std::optional<std::string> on_phase(double at_s, std::string_view behavior,
                                      std::string_view phase);
  std::optional<std::string> on_cycle(double at_s);

 private:
  static constexpr int kTracked = 4;
  struct Awaited {
    std::string_view phase, shown;
    double after_s;  // time after the start of the phase; the end of the phase if that is sooner
    bool taken = false;
  };

  double expected_s_;
  std::string phase_;
  double began_s_ = 0, track_s_ = 0;
  int tracked_ = 0;
  bool catching_ = false;
  Awaited* due_ = nullptr;
  // In 5 s of walking the robot comes 0.2 m nearer. In 1.2 s of holding, the head has turned to the hand.
  std::array<Awaited, 5> caught_{{{"search", "search", 0.5},
                                  {"look", "track", 0.4},
                                  {"walk", "approach", 5},
                                  {"close", "catch", 0},
                                  {"hold", "hold", 1.2}}};
};

}  // namespace kaz::tools
