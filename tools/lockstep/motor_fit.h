// Fits the motor model to a bench report, so that the same bench on the simulated stand measures the same.
// SPDX-License-Identifier: Apache-2.0
//
// Method: indirect inference (C. Gourieroux, A. Monfort, E. Renault 1993, "Indirect Inference", Journal of
// Applied Econometrics 8). A formula estimates each parameter from the measurements. The bench biases these
// estimates by a few percent: A/D codes, duty steps, a motor that warms up. So the bench also runs on the
// model, with the same formulas. Each round corrects the model's parameters by the ratio of both estimates.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/bench/measurement.h"
#include "sim/body/description/motor_file.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::lockstep {

struct FittedParam {
  std::string name, unit;  // as in the motor file
  double before = 0, after = 0;
  bool measured = false;  // false: not determined by the report, and unchanged
};

// Difference between model and measurement.
struct Gap {
  std::string name, unit;  // those of a measurement, or "curve of <plot>"
  double measured = 0;     // NaN for curves
  // Values of the model before and after the fit. For curves: root mean square difference from the measured.
  double before = 0, after = 0;
};

struct MotorFit {
  sim::MotorParams motor;
  std::vector<FittedParam> params;
  std::vector<Gap> gaps;
  std::vector<hil::Plot> plots;  // each with three curves: measured, before, after
  int rounds = 0;
  double last_change = 0;  // largest relative change of a parameter in the last round
};

struct MotorFitOptions {
  std::string joint;       // joint in the report; empty: its only one
  sim::MotorParams start;  // the model before the fit
  // The simulated board: microcontroller and image, sensors, seed. Use h8 for the report of a real board:
  // the bench also measures the firmware's timing, some 0.1 ms of a start.
  sim::SimulationOptions board;
  int max_rounds = 6;
  std::function<void(double share, const std::string& what)> progress;  // share: 0..1; may be null
};

// Returns Fault::usage if the report has no motor, no parameter can be determined, or its disc and supply are
// missing or invalid. A report of several joints needs `joint`. Else errors of the simulation.
Result<MotorFit> fit_motor(const hil::BenchReport& measured, const MotorFitOptions& options);

}  // namespace kaz::lockstep
