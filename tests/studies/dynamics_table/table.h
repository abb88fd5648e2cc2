// Tables of the errors of each dynamics relative to closed-form solutions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

namespace kaz::dynamics_table {

inline constexpr std::array kSteppers{"reduced", "exact", "quick50"};
inline constexpr std::array kStepsMs{0.25, 0.5, 1.0, 2.0, 4.0};
inline constexpr std::array kPendulums{"double pendulum", "triple pendulum"};

struct Row {
  std::string scene, quantity;
  std::string closed;                   // closed form and its value
  std::string unit;                     // unit of the error; "": relative to the value
  std::map<std::string, double> error;  // by dynamics
};

class Table {
 public:
  void put(const std::string& stepper, const std::string& scene, const std::string& quantity,
           const std::string& closed, const std::string& unit, double error);
  const std::vector<Row>& rows() const { return rows_; }
  // Maximum energy error in 10 s over maximum kinetic energy, by pendulum, dynamics and kStepsMs.
  using Energies = std::map<std::string, std::map<std::string, std::vector<double>>>;
  Energies energies;

  std::string markdown() const;
  std::string json() const;

 private:
  std::vector<Row> rows_;
};

// Returns the order of convergence: slope of log error over log step, by least squares. `errors`: by
// kStepsMs.
double slope(const std::vector<double>& errors);

// Each of these runs its scenes with one dynamics and adds the errors to the table.
void fly(const std::string& stepper, Table& table);
void swing(const std::string& stepper, Table& table);
void swing_by_step(const std::string& stepper, Table& table);
void slide(const std::string& stepper, Table& table);
void brake(const std::string& stepper, Table& table);
void roll(const std::string& stepper, Table& table);
void stand(const std::string& stepper, Table& table);

inline void run_all(const std::string& stepper, Table& table) {
  for (const auto scene : {fly, swing, slide, brake, roll, stand}) scene(stepper, table);
}

}  // namespace kaz::dynamics_table
