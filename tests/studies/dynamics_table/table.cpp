// Markdown and JSON of the errors.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/dynamics_table/table.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "tests/studies/common/table.h"

namespace kaz::dynamics_table {
namespace {

using studies::MarkdownTable;
using studies::text;

std::string written(double value) {
  return value == 0 ? "0" : text("%+.1e", value);
}

std::string energy_table(const Table::Energies& energies) {
  std::vector<std::string> heading{"relative energy error in 10 s, at a step of"};
  for (const double step : kStepsMs) heading.push_back(text("%g ms", step));
  heading.emplace_back("slope");
  MarkdownTable table(heading);
  for (const char* pendulum : kPendulums) {
    for (const char* dynamics : kSteppers) {
      const std::vector<double>& errors = energies.at(pendulum).at(dynamics);
      std::vector<std::string> cells{text("%s, %s", pendulum, dynamics)};
      for (const double error : errors) cells.push_back(written(error).substr(1));
      cells.push_back(text("%g", std::round(10 * slope(errors)) / 10));
      table.add(std::move(cells));
    }
  }
  return table.text();
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
  std::vector<std::string> heading{"scene", "quantity", "closed form", "error in"};
  heading.insert(heading.end(), kSteppers.begin(), kSteppers.end());
  MarkdownTable table(heading);
  for (const Row& row : rows_) {
    std::vector<std::string> cells{row.scene, row.quantity, row.closed,
                                   row.unit.empty() ? "relative" : row.unit};
    for (const char* dynamics : kSteppers) {
      const auto found = row.error.find(dynamics);
      cells.push_back(found == row.error.end() ? "–" : written(found->second));
    }
    table.add(std::move(cells));
  }
  return energies.empty() ? table.text() : table.text() + "\n" + energy_table(energies);
}

std::string Table::json() const {
  nlohmann::ordered_json all;
  all["rows"] = nlohmann::ordered_json::array();
  for (const Row& row : rows_) {
    all["rows"].push_back({{"scene", row.scene},
                           {"quantity", row.quantity},
                           {"closed_form", row.closed},
                           {"unit", row.unit.empty() ? "relative" : row.unit},
                           {"error", row.error}});
  }
  all["step_ms"] = kStepsMs;
  all["relative_energy_error"] = energies;
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
