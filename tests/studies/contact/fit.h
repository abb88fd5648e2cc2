// Fits the contact parameters of an engine to tosses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tests/studies/contact/engine.h"

namespace kaz::contact {

struct FitOptions {
  // Each generation simulates all tosses once with each of `population` candidates (even, at least 4).
  int generations = 16, population = 8;
  std::uint64_t seed = 1;
  int jobs = 1;  // threads
  // Reads the finished share (0..1) and the best score so far; may be empty.
  std::function<void(double share, double score)> progress = {};
};

struct Fit {
  std::vector<double> values;  // one for each parameter of the engine
  double score = 0;            // mean error of the fitted tosses
  int evaluations = 0;         // number of candidates that were simulated
};

// Returns path_error() of each toss.
Result<std::vector<double>> toss_errors(const Engine& engine, std::span<const Toss> tosses,
                                        std::span<const double> values, int jobs);

// Minimizes the mean error by the evolution strategy of tests/studies/balance within the bounds of the
// parameters, from their start values. Returns the best candidate. The result depends only on tosses, engine,
// seed, generations and population.
Result<Fit> fit_engine(const Engine& engine, std::span<const Toss> tosses,
                       const FitOptions& options);

}  // namespace kaz::contact
