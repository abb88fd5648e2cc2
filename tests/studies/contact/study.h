// Fits and judges engines in two folds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tests/studies/contact/fit.h"
#include "tests/studies/contact/phases.h"
#include "tests/studies/contact/score.h"

namespace kaz::contact {

// Returns the fold of a toss: 0 if number mod 4 is 0 or 1, otherwise 1. The tosses of a fold are judged with
// the values that were fitted to the other fold.
int fold_of(const Toss& toss);

using FoldValues = std::array<std::vector<double>, 2>;  // values fitted to each fold

// Result of an engine over all tosses, each judged with the values of the other fold.
struct Judged {
  std::vector<double> errors;  // path_error() of each toss
  std::vector<int> wrong;      // 1 if the simulated cube ends on another face than the measured one
  PhaseErrors
      right_phases{};  // sum of phase_errors() of the tosses with the right face, over all tosses
};

struct Row {
  Engine engine;
  std::array<Fit, 2> fits;  // fit to each fold
  Judged judged;
};

// Fits both folds. `progress` reads a sentence from time to time.
Result<std::array<Fit, 2>> fit_folds(const Engine& engine, std::span<const Toss> tosses,
                                     const FitOptions& options,
                                     const std::function<void(const std::string&)>& progress);

// Simulates each toss with the values of the other fold.
Result<Judged> judge(const Engine& engine, std::span<const Toss> tosses, const FoldValues& values,
                     int jobs);

// Returns the values with which a toss is judged.
std::span<const double> values_for(const Row& row, const Toss& toss);

}  // namespace kaz::contact
