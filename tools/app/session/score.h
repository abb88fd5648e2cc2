// How well the head was kept on the ball.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/behavior/sink.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::tools {

struct Score {
  // "truth": the ball's position in the simulated world; "pictures": that in the left eye's pictures,
  // a picture without the ball counting as a miss.
  std::string measured_by;
  // From the start of the run to when tracking began. Without it all else is empty.
  std::optional<double> found_s;
  std::vector<double> time_s;  // from the start of the run
  std::vector<double>
      error_deg;  // between the left eye's axis and the ball; NaN: not in the picture
  std::optional<double> within_3deg;  // share of the samples after found_s; nothing without samples
  std::optional<double> rms_deg;      // of the samples that are not NaN
};

// Takes a sample of the truth at each control cycle. For scoring only: no behaviour sees it.
class TruthProbe {
 public:
  explicit TruthProbe(sim::Simulation& simulation) : simulation_(simulation) {}

  void sample();

  struct Sample {
    Time time{};
    double error_rad = 0;
    double pan_rad = 0, tilt_rad = 0;  // of the joints, without noise
  };
  const std::vector<Sample>& samples() const { return samples_; }

 private:
  sim::Simulation& simulation_;
  std::vector<Sample> samples_;
};

// `probe` may be null. Times count from `start`.
Score score(const behavior::Recording& recording, const TruthProbe* probe, Time start);

}  // namespace kaz::tools
