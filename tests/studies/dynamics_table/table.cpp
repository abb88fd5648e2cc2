// Differences of the steppers from closed forms, as Markdown and JSON.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/dynamics_table/table.h"

#include <cmath>
#include <cstdio>
#include <sstream>

#include <nlohmann/json.hpp>

namespace kaz::dynamics_table {
namespace {

std::string written(double value) {
  if (value == 0) return "0";
  char text[32];
  std::snprintf(text, sizeof text, "%+.1e", value);
  return text;
}

}  // namespace

void Table::put(const std::string& stepper, const std::string& scene, const std::string& quantity,
                const std::string& closed, const std::string& unit, double error) {
  for (Row& row : rows_) {
    if (row.scene != scene || row.quantity != quantity) continue;
    row.error[stepper] = error;
    return;
  }
  rows_.push_back({scene, quantity, closed, unit, {{stepper, error}}});
}

std::string Table::markdown() const {
  std::ostringstream text;
  text << "| scene | quantity | closed form | error in |";
  for (const char* stepper : kSteppers) text << " " << stepper << " |";
  text << "\n|---|---|---|---|";
  for (std::size_t i = 0; i < kSteppers.size(); ++i) text << "---|";
  text << "\n";
  for (const Row& row : rows_) {
    text << "| " << row.scene << " | " << row.quantity << " | " << row.closed << " | "
         << (row.unit.empty() ? "share" : row.unit) << " |";
    for (const char* stepper : kSteppers) {
      const auto found = row.error.find(stepper);
      text << " " << (found == row.error.end() ? std::string("–") : written(found->second)) << " |";
    }
    text << "\n";
  }
  if (energies.empty()) return text.str();
  text << "\n| energy in 10 s, share, at a step of |";
  for (const double step : kStepsMs) text << " " << step << " ms |";
  text << " slope |\n|---|";
  for (std::size_t i = 0; i < kStepsMs.size(); ++i) text << "---|";
  text << "---|\n";
  for (const char* pendulum : kPendulums) {
    for (const char* stepper : kSteppers) {
      const std::vector<double>& errors = energies.at(pendulum).at(stepper);
      text << "| " << pendulum << ", " << stepper << " |";
      for (const double error : errors) text << " " << written(error).substr(1) << " |";
      text << " " << std::round(10 * slope(errors)) / 10 << " |\n";
    }
  }
  return text.str();
}

std::string Table::json() const {
  nlohmann::ordered_json all;
  all["rows"] = nlohmann::ordered_json::array();
  for (const Row& row : rows_) {
    all["rows"].push_back({{"scene", row.scene},
                           {"quantity", row.quantity},
                           {"closed_form", row.closed},
                           {"unit", row.unit.empty() ? "share" : row.unit},
                           {"error", row.error}});
  }
  all["step_ms"] = kStepsMs;
  all["energy_share"] = energies;
  return all.dump(2) + "\n";
}

double slope(const std::vector<double>& errors) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const auto n = static_cast<double>(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double a = std::log10(kStepsMs[i]), b = std::log10(errors[i]);
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace kaz::dynamics_table
