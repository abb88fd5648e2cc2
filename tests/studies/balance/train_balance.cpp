// train_balance: learns the weights of the balance policy (host/motion/balance.h), and tests them.
// SPDX-License-Identifier: Apache-2.0
//
// Each candidate walks: the whole robot with its firmware compiled for this machine, host stack and
// serial line in lockstep, as the walking table has it. The weights depend on the arguments alone,
// --jobs excepted.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <thread>

#include <CLI/CLI.hpp>

#include "host/motion/balance.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/enum_names.hpp"
#include "shared/base/files.hpp"
#include "shared/base/random.hpp"
#include "tests/studies/balance/evolution.h"
#include "tests/studies/common/program.h"
#include "tests/studies/common/table.h"
#include "tests/studies/walking/course.h"

namespace {

using namespace kaz;
using namespace kaz::walking;
using Eigen::VectorXd;
using motion::BalancePolicy;
using studies::text;

struct Arguments {
  std::string out = "out/balance";
  std::uint64_t seed = 1;
  int jobs = 1, generations = 30, population = 24, episodes = 5;
  // Of a test.
  std::string test;
  sim::McuKind mcu = sim::McuKind::h8;
  std::string mcu_name = "h8";
  double push_ns = 0.5;
};

constexpr double kDistance_m = 1, kMost_s = 35;

// How a walk under pushes went, 0 to about 2: how far it came, how long it stood, less what it lost
// of its way.
struct Score {
  double value = 0;
  bool fell = true;
};
Score score_of(const Outcome& outcome) {
  const double ahead = std::clamp(outcome.forward_m / kDistance_m, 0.0, 1.0);
  const double stood = outcome.fell ? std::min(outcome.seconds / kMost_s, 1.0) : 1.0;
  const double late = outcome.fell ? 0 : std::max(0.0, outcome.seconds / 20 - 1);
  return {ahead + stood - 0.2 * std::min(1.0, std::abs(outcome.aside_m)) -
              0.1 * std::min(1.0, std::abs(outcome.heading_deg) / 30) - 0.1 * late,
          outcome.fell};
}

Trial walk(const std::string& policy) {
  Trial trial{.name = "balance", .options = {{"distance", "1"}, {"balance", policy}}};
  trial.most_s = kMost_s;
  return trial;
}

// Of five episodes three have pushes to the sides, one pushes from all around, one none. None comes
// at a time that can be learned.
Trial training_walk(const std::string& policy, int episode, std::uint64_t seed) {
  Trial trial = walk(policy);
  const double share = Random(mix64(seed)).uniform();
  trial.push_jitter_s = 0.3;
  if (episode % 5 < 3) {
    trial.push_ns = 0.42 + 0.14 * share;
    trial.push_sides = true;
  } else if (episode % 5 == 3) {
    trial.push_ns = 0.25 + 0.2 * share;
  }
  return trial;
}

Result<Outcome> run(const Trial& trial, sim::McuKind mcu, std::uint64_t seed) {
  return run_trial(trial, {.mcu = mcu, .image_path = KAZ_FIRMWARE_IMAGE, .robot_folder = KAZ_ROBOT},
                   seed);
}

// Calls work(i) for 0..count-1 on `jobs` threads.
template <class Work>
void side_by_side(int jobs, int count, const Work& work) {
  std::atomic<int> next{0};
  std::vector<std::jthread> threads;
  for (int t = 0; t < jobs; ++t)
    threads.emplace_back([&] {
      for (int i; (i = next++) < count;) work(i);
    });
}

std::string weights_text(const VectorXd& weights, const std::string& head) {
  std::string all = "// " + head + "\n";
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    all += text("%.9g,%s", weights[i], i % 8 == 7 || i + 1 == weights.size() ? "\n" : " ");
  return all;
}

// Random in the hidden layer, nil behind it: the policy begins with correcting nothing.
VectorXd first_weights(std::uint64_t seed) {
  VectorXd weights = VectorXd::Zero(BalancePolicy::kWeights);
  for (int i = 0; i < BalancePolicy::kInputs * BalancePolicy::kHidden; ++i)
    weights[i] = 0.5 * keyed_normal(seed, static_cast<std::uint64_t>(i), 2);
  return weights;
}

// What decides the weights.
nlohmann::json problem_of(const Arguments& a) {
  return {{"seed", a.seed}, {"population", a.population}, {"episodes", a.episodes}};
}

Result<void> train(const Arguments& a, const std::string& command) {
  namespace fs = std::filesystem;
  std::error_code wrong;
  fs::create_directories(a.out, wrong);
  if (wrong) return fail(Fault::environment, a.out + ": cannot be created: " + wrong.message());
  balance::Evolution evolution(first_weights(a.seed), 0.15, a.population, a.seed);
  const std::string state_file = a.out + "/state.json";
  if (fs::exists(state_file)) {
    const auto state =
        parse_bounded_json(KAZ_TRY(read_whole_file(state_file, 1 << 24))).value_or(nullptr);
    if (!state.is_object() || state.value("problem", nlohmann::json()) != problem_of(a))
      return fail(
          Fault::usage,
          state_file + " is of a training with other arguments; give the same, or another --out");
    if (auto resumed = evolution.resume(state.value("evolution", nlohmann::json())); !resumed)
      return fail(Fault::usage, state_file + ": " + resumed.error().message);
    std::printf("goes on after generation %d\n", evolution.generation());
  }
  const auto begun = std::chrono::steady_clock::now();
  while (evolution.generation() < a.generations) {
    const int count = a.population * a.episodes, generation = evolution.generation();
    std::vector<std::string> policies;
    for (const auto& candidate : evolution.candidates().colwise())
      policies.push_back(weights_text(candidate, "candidate"));
    std::vector<Score> scores(static_cast<std::size_t>(count));
    std::vector<std::string> errors(static_cast<std::size_t>(count));
    side_by_side(a.jobs, count, [&](int i) {
      const int candidate = i % a.population, episode = i / a.population;
      // All candidates of a generation walk under the same pushes.
      const std::uint64_t seed =
          mix64(mix64(a.seed) + static_cast<std::uint64_t>(generation * a.episodes + episode)) >>
          16;
      const auto outcome =
          run(training_walk(policies[static_cast<std::size_t>(candidate)], episode, seed),
              sim::McuKind::native, seed);
      const auto at = static_cast<std::size_t>(i);
      if (outcome) {
        scores[at] = score_of(*outcome);
      } else {
        errors[at] = outcome.error().message;
      }
    });
    for (const std::string& error : errors)
      if (!error.empty()) return fail(Fault::environment, "a walk could not be run: " + error);
    std::vector<double> values(static_cast<std::size_t>(a.population));
    int fell = 0;
    double mean = 0;
    for (int i = 0; i < count; ++i) {
      const Score& score = scores[static_cast<std::size_t>(i)];
      values[static_cast<std::size_t>(i % a.population)] += score.value / a.episodes;
      fell += score.fell;
      mean += score.value / count;
    }
    evolution.advance(values);
    KAZ_TRY(write_whole_file(
        a.out + "/learned_balance.inc",
        weights_text(evolution.mean(), "Balance policy (balance.h), written by `" + command +
                                           "`, generation " +
                                           std::to_string(evolution.generation()) + ".")));
    KAZ_TRY(write_whole_file(
        state_file,
        nlohmann::json{{"problem", problem_of(a)}, {"evolution", evolution.state()}}.dump() +
            "\n"));
    const double minutes =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count() / 60;
    std::printf("generation %3d of %d: score %.3f, best %.3f, fell %4.1f %%, step %.3f, %.1f min\n",
                evolution.generation(), a.generations, mean, *std::ranges::max_element(values),
                studies::percent(fell, count), evolution.sigma(), minutes);
    std::fflush(stdout);
  }
  std::printf(
      "%s/learned_balance.inc; kaz run go-forward --imu --set balance=%s/learned_balance.inc\n",
      a.out.c_str(), a.out.c_str());
  return {};
}

// The course: a metre under pushes of one size, one each 1.5 s, each to the left or the right.
Result<void> test(const Arguments& a) {
  const bool word = a.test == "none" || a.test == "learned";
  const std::string policy = word ? a.test : KAZ_TRY(read_whole_file(a.test, 1 << 20));
  std::vector<Result<Outcome>> outcomes(static_cast<std::size_t>(a.episodes),
                                        fail(Fault::failed, ""));
  side_by_side(a.jobs, a.episodes, [&](int i) {
    Trial trial = walk(policy);
    trial.push_ns = a.push_ns;
    trial.push_sides = true;
    outcomes[static_cast<std::size_t>(i)] =
        run(trial, a.mcu, a.seed + static_cast<std::uint64_t>(i));
  });
  int stood = 0;
  for (int i = 0; i < a.episodes; ++i) {
    const auto& outcome = outcomes[static_cast<std::size_t>(i)];
    if (!outcome) return tl::unexpected(outcome.error());
    stood += !outcome->fell;
    std::printf("seed %llu: %s, %.3f m ahead, %+.3f m aside, heading %+.1f degrees, %.1f s\n",
                static_cast<unsigned long long>(a.seed + static_cast<std::uint64_t>(i)),
                outcome->fell ? "FELL" : "stood", outcome->forward_m, outcome->aside_m,
                outcome->heading_deg, outcome->seconds);
  }
  std::printf("%d of %d stood\n", stood, a.episodes);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  CLI::App app(
      "Learns the balance policy of go-forward under pushes, by an evolution strategy. Goes on "
      "where it was "
      "interrupted; the weights depend on seed, population and episodes alone.");
  app.add_option("--out", a.out, "folder for learned_balance.inc and state.json")
      ->capture_default_str();
  app.add_option("--seed", a.seed, "of the training, or the first one of a test")
      ->capture_default_str();
  app.add_option("--jobs", a.jobs, "threads")->check(CLI::Range(1, 256))->capture_default_str();
  app.add_option("--generations", a.generations, "of the evolution")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--population", a.population, "candidates of a generation, an even number")
      ->check(CLI::Range(4, 1000))
      ->capture_default_str();
  app.add_option("--episodes", a.episodes, "walks of each candidate, or of a test")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--test", a.test, "test weights instead: none, learned, or a file")
      ->type_name("WEIGHTS");
  app.add_option("--mcu", a.mcu_name, "of a test: h8, native")
      ->check(CLI::IsMember(enum_names(sim::kMcuKinds)))
      ->capture_default_str();
  app.add_option("--push", a.push_ns, "of a test: N s")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
  app.footer("train_balance --jobs 2\ntrain_balance --test learned --episodes 50 --seed 9001");
  return studies::run_program(app, "train_balance", argc, argv, [&]() -> Result<void> {
    if (a.population % 2 != 0) return fail(Fault::usage, "--population: give an even number");
    a.mcu = parse_enum(sim::kMcuKinds, a.mcu_name).value();
    return a.test.empty()
               ? train(a, "./tools/dev study train-balance --seed " + std::to_string(a.seed))
               : test(a);
  });
}
