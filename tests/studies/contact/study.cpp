// Fits of both folds, and the judged rows.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/contact/study.h"

#include <chrono>

#include "tests/studies/common/run_jobs.h"
#include "tests/studies/common/table.h"

namespace kaz::contact {
namespace {

std::vector<Toss> tosses_of(std::span<const Toss> all, int fold) {
  std::vector<Toss> out;
  for (const Toss& toss : all)
    if (fold_of(toss) == fold) out.push_back(toss);
  return out;
}

// Passes on a message at most every 2 s.
class Progress {
 public:
  explicit Progress(const std::function<void(const std::string&)>& out) : out_(out) {}
  void operator()(const std::string& message) {
    const auto now = std::chrono::steady_clock::now();
    if (!out_ || now - last_ < std::chrono::seconds(2)) return;
    last_ = now;
    out_(message);
  }

 private:
  const std::function<void(const std::string&)>& out_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

int fold_of(const Toss& toss) {
  return toss.number % 4 < 2 ? 0 : 1;
}

Result<std::array<Fit, 2>> fit_folds(const Engine& engine, std::span<const Toss> tosses,
                                     const FitOptions& options,
                                     const std::function<void(const std::string&)>& progress) {
  std::array<Fit, 2> fits;
  Progress report(progress);
  for (int fold = 0; fold < 2; ++fold) {
    FitOptions own = options;
    own.progress = [&](double share, double score) {
      report(engine.name +
             studies::text(", fold %d of 2: %.0f %%, score %.4f", fold + 1, 100 * share, score));
    };
    fits[static_cast<std::size_t>(fold)] =
        KAZ_TRY(fit_engine(engine, tosses_of(tosses, fold), own));
  }
  return fits;
}

Result<Judged> judge(const Engine& engine, std::span<const Toss> tosses, const FoldValues& values,
                     int jobs) {
  std::vector<Path> paths(tosses.size());
  KAZ_TRY(studies::run_jobs(tosses.size(), jobs, [&](std::size_t i) {
    const auto other = static_cast<std::size_t>(1 - fold_of(tosses[i]));
    auto path = engine.simulate(tosses[i], values[other]);
    return [&, i, path = std::move(path)]() -> Result<void> {
      if (!path) return tl::unexpected(path.error());
      paths[i] = *path;
      return {};
    };
  }));
  Judged out;
  for (std::size_t i = 0; i < tosses.size(); ++i) {
    out.errors.push_back(path_error(tosses[i].path, paths[i]));
    const bool wrong = final_face(tosses[i].path) != final_face(paths[i]);
    out.wrong.push_back(wrong ? 1 : 0);
    if (wrong) continue;
    const PhaseErrors phases = phase_errors(tosses[i], paths[i]);
    for (std::size_t k = 0; k < phases.size(); ++k) out.right_phases[k] += phases[k];
  }
  return out;
}

std::span<const double> values_for(const Row& row, const Toss& toss) {
  return row.fits[static_cast<std::size_t>(1 - fold_of(toss))].values;
}

}  // namespace kaz::contact
