// Score of ball tracking: measures how well the head was directed at the ball.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/behavior/sink.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::tools {

struct Score {
  // "truth": errors are computed from the ball's position in the simulated world. "pictures": errors are
  // computed from the ball's position in the left eye's pictures. A picture without the ball counts as a
  // miss.
  std::string measured_by;
  // Time from the start of the run until tracking began. If found_s is empty, all other members are empty,
  // too.
  std::optional<double> found_s;
  std::vector<double> time_s;  // times of the samples since the start of the run
  // Angle between the left eye's axis and the ball for each sample. NaN: the ball is not in the picture.
  std::vector<double> error_deg;
  // Share (0 to 1) of the samples after found_s with an error below 3 degrees; empty without samples.
  std::optional<double> within_3deg;
  std::optional<double> rms_deg;  // root mean square of the errors after found_s, without NaN
};

// Samples the ground truth at each control cycle, for scoring only. Behaviors have no access to the ground
// truth.
class TruthProbe {
 public:
  explicit TruthProbe(sim::Simulation& simulation) : simulation_(simulation) {}

  void sample();

  struct Sample {
    Time time{};
    double error_rad = 0;
    double pan_rad = 0, tilt_rad = 0;  // true joint angles, without noise
  };
  const std::vector<Sample>& samples() const { return samples_; }

 private:
  sim::Simulation& simulation_;
  std::vector<Sample> samples_;
};

// Computes the score. If `probe` is null, uses the pictures. Times count from `start`.
Score score(const behavior::Recording& recording, const TruthProbe* probe, Time start);

}  // namespace kaz::tools
