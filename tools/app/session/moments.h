// Which moments of a run are worth a picture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace kaz::tools {

// Of catch-ball: searching, tracking, walking there, the hand at the ball, the ball held. Of
// everything else that tracks: four, spread evenly over that time. Seconds are of the robot, since the
// start.
class Moments {
 public:
  explicit Moments(double expected_s) : expected_s_(expected_s) {}
  Moments(const Moments&) = delete;
  Moments& operator=(const Moments&) = delete;

  // What there is to see now, if a picture is due.
  std::optional<std::string> on_phase(double at_s, std::string_view behavior,
                                      std::string_view phase);
  std::optional<std::string> on_cycle(double at_s);

 private:
  static constexpr int kTracked = 4;
  struct Awaited {
    std::string_view phase, shown;
    double after_s;  // into the phase, or at its end if that is sooner
    bool taken = false;
  };

  double expected_s_;
  std::string phase_;
  double began_s_ = 0, track_s_ = 0;
  int tracked_ = 0;
  bool catching_ = false;
  Awaited* due_ = nullptr;
  // In 5 s of walking it comes 0.2 m nearer; in 1.2 s of holding the head has turned to the hand.
  std::array<Awaited, 5> caught_{{{"search", "search", 0.5},
                                  {"look", "track", 0.4},
                                  {"walk", "approach", 5},
                                  {"close", "catch", 0},
                                  {"hold", "hold", 1.2}}};
};

}  // namespace kaz::tools
