// Selects the moments of a run at which pictures are taken.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/behavior/behavior.h"

namespace kaz::tools {

// Moments are the milestones of a behavior. For a behavior without milestones, the phase `track` has four
// moments, spread evenly over the expected time. All times are in s of robot time since the start.
class Moments {
 public:
  explicit Moments(double expected_s) : expected_s_(expected_s) {}
  Moments(const Moments&) = delete;
  Moments& operator=(const Moments&) = delete;

  // Call on_phase() when a phase begins, and on_cycle() at each control cycle. If a picture is due, the
  // functions return the name of the picture's moment, else nullopt. The four moments of the phase `track`
  // have an empty name. `milestones`: those of the behavior that reports the phase; must outlive this object.
  std::optional<std::string> on_phase(double at_s, std::span<const behavior::Milestone> milestones,
                                      std::string_view phase);
  std::optional<std::string> on_cycle(double at_s);

 private:
  static constexpr int kTracked = 4;

  double expected_s_;
  std::string phase_;
  double began_s_ = 0, track_s_ = 0;
  int tracked_ = 0;
  bool has_milestones_ = false;
  const behavior::Milestone* due_ = nullptr;
  std::vector<const behavior::Milestone*> begun_;  // milestones whose phase has begun
};

}  // namespace kaz::tools
