// Selects the moments of a run at which pictures are taken.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace kaz::tools {

// catch-ball has five moments: searching, tracking, approaching, the hand at the ball, the ball held. Other
// behaviors with a phase `track` have four moments, spread evenly over the expected time. All times are in s
// of robot time since the start.
class Moments {
 public:
  explicit Moments(double expected_s) : expected_s_(expected_s) {}
  Moments(const Moments&) = delete;
  Moments& operator=(const Moments&) = delete;

  // Call on_phase() when a phase begins, and on_cycle() at each control cycle. If a picture is due, the
  // functions return the name of the picture's moment, else nullopt. The moments of the phase `track` have an
  // empty name, except in catch-ball.
  std::optional<std::string> on_phase(double at_s, std::string_view behavior,
                                      std::string_view phase);
  std::optional<std::string> on_cycle(double at_s);

 private:
  static constexpr int kTracked = 4;
  struct Awaited {
    std::string_view phase, shown;
    // Time from the start of the phase to the moment; if the phase ends earlier, the moment is its end.
    double after_s;
    bool taken = false;
  };

  double expected_s_;
  std::string phase_;
  double began_s_ = 0, track_s_ = 0;
  int tracked_ = 0;
  bool catching_ = false;
  Awaited* due_ = nullptr;
  // Reasons for the times: after 5 s of walking, the robot is 0.2 m nearer to the ball. After 1.2 s of
  // holding, the head has turned to the hand.
  std::array<Awaited, 5> caught_{{{"search", "search", 0.5},
                                  {"look", "track", 0.4},
                                  {"walk", "approach", 5},
                                  {"close", "catch", 0},
                                  {"hold", "hold", 1.2}}};
};

}  // namespace kaz::tools
