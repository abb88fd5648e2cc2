// Simulates candidates on all cores, and searches the best one.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/contact/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/studies/balance/evolution.h"
#include "tests/studies/common/run_jobs.h"
#include "tests/studies/contact/score.h"

namespace kaz::contact {
namespace {

constexpr double kSigma = 0.15;  // initial step size, in shares of a parameter's range

// Mean error of each candidate. `values`: values of each candidate.
Result<std::vector<double>> mean_errors(const Engine& engine, std::span<const Toss> tosses,
                                        const std::vector<std::vector<double>>& values, int jobs) {
  std::vector<std::vector<double>> errors(values.size(), std::vector<double>(tosses.size()));
  KAZ_TRY(studies::run_jobs(values.size() * tosses.size(), jobs, [&](std::size_t job) {
    const std::size_t candidate = job / tosses.size(), toss = job % tosses.size();
    auto path = engine.simulate(tosses[toss], values[candidate]);
    return [&, candidate, toss, path = std::move(path)]() -> Result<void> {
      if (!path) return tl::unexpected(path.error());
      errors[candidate][toss] = path_error(tosses[toss].path, *path);
      return {};
    };
  }));
  std::vector<double> means;
  for (const auto& each : errors) means.push_back(mean(each));
  return means;
}

// Values of a candidate, and the squared distance by which its shares are outside 0..1.
struct Candidate {
  std::vector<double> values;
  double outside = 0;
};

Candidate candidate_of(const Engine& engine, const Eigen::VectorXd& shares) {
  Candidate out;
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    const double inside = std::clamp(shares[i], 0.0, 1.0);
    out.outside += (shares[i] - inside) * (shares[i] - inside);
    out.values.push_back(engine.parameters[static_cast<std::size_t>(i)].value_at(inside));
  }
  return out;
}

}  // namespace

Result<std::vector<double>> toss_errors(const Engine& engine, std::span<const Toss> tosses,
                                        std::span<const double> values, int jobs) {
  std::vector<double> errors(tosses.size());
  KAZ_TRY(studies::run_jobs(tosses.size(), jobs, [&](std::size_t i) {
    auto path = engine.simulate(tosses[i], values);
    return [&, i, path = std::move(path)]() -> Result<void> {
      if (!path) return tl::unexpected(path.error());
      errors[i] = path_error(tosses[i].path, *path);
      return {};
    };
  }));
  return errors;
}

Result<Fit> fit_engine(const Engine& engine, std::span<const Toss> tosses,
                       const FitOptions& options) {
  Eigen::VectorXd mean(static_cast<Eigen::Index>(engine.parameters.size()));
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    const Parameter& one = engine.parameters[static_cast<std::size_t>(i)];
    mean[i] = one.share_of(one.start);
  }
  balance::Evolution search(mean, kSigma, options.population, options.seed);
  Fit best{engine.start(), std::numeric_limits<double>::infinity(), 0};
  for (int generation = 0; generation < options.generations; ++generation) {
    std::vector<std::vector<double>> values;
    std::vector<double> scores;
    for (Eigen::Index k = 0; k < search.candidates().cols(); ++k) {
      Candidate one = candidate_of(engine, search.candidates().col(k));
      values.push_back(std::move(one.values));
      scores.push_back(-one.outside);
    }
    // The last generation also tries the mean of the search.
    if (generation + 1 == options.generations)
      values.push_back(candidate_of(engine, search.mean()).values);
    const auto errors = KAZ_TRY(mean_errors(engine, tosses, values, options.jobs));
    for (std::size_t k = 0; k < errors.size(); ++k) {
      if (k < scores.size()) scores[k] -= errors[k];
      if (errors[k] < best.score) best = {values[k], errors[k], best.evaluations};
    }
    best.evaluations += static_cast<int>(errors.size());
    search.advance(scores);
    if (options.progress) options.progress((generation + 1.0) / options.generations, best.score);
  }
  return best;
}

}  // namespace kaz::contact
