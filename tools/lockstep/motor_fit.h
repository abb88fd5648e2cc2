// From a bench's report to the parameters of the motor model: those with which the same bench, run on
// the simulated stand, finds the same.
// SPDX-License-Identifier: Apache-2.0
//
// Each parameter has an estimate by formula from the measurements, which what the bench itself does to
// them (codes, steps of the duty, a motor that warms meanwhile) puts off by some per cent. So the
// bench is run on the model, too, and the model's parameter is corrected by the ratio of both estimates,
// over and over: indirect inference (C. Gourieroux, A. Monfort, E. Renault 1993, "Indirect
// Inference", Journal of Applied Econometrics 8).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/bench/measurement.h"
#include "sim/body/description/motor_file.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::lockstep {

struct FittedParam {
  std::string name, unit;  // of the motor file
  double before = 0, after = 0;
  bool measured = false;  // false: the bench said nothing of it, and it stays
};

// How far the model is from what was measured.
struct Gap {
  std::string name, unit;        // a measurement's, or "curve of <plot>"
  double measured = 0;           // NaN for curves
  double before = 0, after = 0;  // the model's value; for curves root mean square of the difference
};

struct MotorFit {
  sim::MotorParams motor;
  std::vector<FittedParam> params;
  std::vector<Gap> gaps;
  std::vector<hil::Plot> plots;  // measured, before and after in one
  int rounds = 0;
  double last_change = 0;  // largest relative change of a parameter in the last round
};

struct MotorFitOptions {
  std::string joint;       // subject of the report; empty: the only one there is
  sim::MotorParams start;  // the model before
  // The simulated board: engine and image, sensors, seed. The firmware's own timing is part of what
  // the bench measures, some 0.1 ms of a start: h8 is the model of a real board.
  sim::SimulationOptions board;
  int max_rounds = 6;
  std::function<void(double share, const std::string& what)> progress;
};

// Errors (usage): the report is not one of a motor, or determines no parameter; several
// joints and none chosen. Else those of the simulation.
Result<MotorFit> fit_motor(const hil::BenchReport& measured, const MotorFitOptions& options);

}  // namespace kaz::lockstep
