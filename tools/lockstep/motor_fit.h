// Fits the motor model to a bench report. A simulated bench with the fitted model reproduces the measurements
// of the report.
// SPDX-License-Identifier: Apache-2.0
//
// Method: indirect inference (C. Gourieroux, A. Monfort, E. Renault 1993, "Indirect Inference", Journal of
// Applied Econometrics 8). A formula estimates each parameter from the measurements. The resolutions of A/D
// converter and duty cycle, and the warming of the motor, bias these estimates by a few percent. To remove
// this bias, the fit runs in rounds. In each round, a simulated bench measures the model. The same formulas
// then estimate the model's parameters from the simulated measurements. If an estimate from the report is r
// times the estimate from the simulated bench, the parameter of the model is multiplied by r.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/bench/measurement.h"
#include "sim/body/description/motor_file.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::lockstep {

struct FittedParam {
  std::string name, unit;  // name and unit in the motor file
  double before = 0, after = 0;
  // False: the report does not determine the parameter, and the parameter keeps its value.
  bool measured = false;
};

// Difference between model and measurement.
struct Gap {
  // Name and unit of a measurement; for a curve, the name is "curve of <plot>".
  std::string name, unit;
  double measured = 0;  // NaN for curves
  // Values of the model before and after the fit. For a curve: root mean square of the difference from the
  // measured curve.
  double before = 0, after = 0;
};

struct MotorFit {
  sim::MotorParams motor;
  std::vector<FittedParam> params;
  std::vector<Gap> gaps;
  std::vector<hil::Plot> plots;  // each plot has three curves: measured, before, after
  int rounds = 0;
  double last_change = 0;  // largest relative change of a parameter in the last round
};

struct MotorFitOptions {
  std::string joint;       // name of the joint in the report; empty: the only joint of the report
  sim::MotorParams start;  // parameters of the model before the fit
  // Options of the simulated board: microcontroller and image, sensors, seed. For the report of a real board,
  // use the microcontroller h8. The measurements include delays of the firmware, such as 0.1 ms when a motor
  // starts. Only h8 simulates these delays.
  sim::SimulationOptions board;
  int max_rounds = 6;
  // `share`: progress, 0..1. May be null.
  std::function<void(double share, const std::string& what)> progress;
};

// Fits the model to the report `measured`. Returns Fault::usage if no parameter of the motor can be
// determined from the report. Returns Fault::usage if the report contains no measurement of a motor. Returns
// Fault::usage if the report lacks `disc_kgm2` or `supply_volts`. Returns Fault::usage if the value of
// `disc_kgm2`, `supply_volts` or `pressing_s` is out of range. Also returns Fault::usage if the report has
// several joints and options.joint is empty. Other errors come from the simulation.
Result<MotorFit> fit_motor(const hil::BenchReport& measured, const MotorFitOptions& options);

}  // namespace kaz::lockstep
