// Reports a fit of a servo's model as JSON, HTML and text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "hil/servo/servo_score.h"
#include "shared/plot/plot.h"

namespace kaz::tools {

// Returns the model with the smallest error on the held-out logs, or without such logs on the fitted ones. If
// several models are within 3 % of the smallest error, returns the simplest. `fits` must not be empty.
const hil::ServoFit& chosen_fit(const std::vector<hil::ServoFit>& fits, bool held_out);

struct ServoResult {
  std::vector<hil::ServoLog> logs, held_out;
  std::vector<hil::ServoFit> fits;
  // Score of the chosen fit, on the held-out logs or without such logs on the fitted ones.
  hil::ServoScore score;
  bool current = false;  // the logs have currents

  const hil::ServoFit& best() const { return chosen_fit(fits, !held_out.empty()); }
};

nlohmann::ordered_json servo_json(const ServoResult& result);
nlohmann::ordered_json servo_score_json(const hil::ServoScore& score);
std::string servo_text(const ServoResult& result);
std::string servo_html(const ServoResult& result, const std::vector<plot::PlotPage>& plots);

// Plots the motion of a held-out log, and the predictions of the first and the chosen model.
plot::PlotPage servo_plot(const ServoResult& result, const hil::ServoLog& log);

}  // namespace kaz::tools
