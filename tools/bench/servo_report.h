// Reports a fit of a servo's model as JSON, HTML and text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "hil/servo/input_check.h"
#include "hil/servo/servo_score.h"
#include "shared/plot/plot.h"

namespace kaz::tools {

struct ServoResult {
  std::vector<hil::ServoLog> logs, held_out;
  std::vector<hil::ServoFit> fits;
  // Score of the chosen fit, on the held-out logs or without such logs on the fitted ones.
  hil::ServoScore score;
  // Score of the held-out logs with zeros fitted to them; no groups if all rigs have fitted logs.
  hil::ServoScore own_zeros_score;
  std::vector<hil::WrongInput> wrong;  // stated values that contradict the logs
  bool current = false;                // the logs have currents

  const hil::ServoFit& best() const { return hil::chosen_fit(fits); }
};

// Scores the chosen fit and checks the stated values of all logs. Errors: `options.stopped` (interrupted).
Result<void> judge_servo(ServoResult& result, const hil::ServoFitOptions& options);

nlohmann::ordered_json servo_json(const ServoResult& result);
nlohmann::ordered_json servo_score_json(const hil::ServoScore& score);
std::string servo_text(const ServoResult& result);
std::string servo_html(const ServoResult& result, const std::vector<plot::PlotPage>& plots);

// Plots the motion of a held-out log, and the predictions of the first and the chosen model.
plot::PlotPage servo_plot(const ServoResult& result, const hil::ServoLog& log);

}  // namespace kaz::tools
