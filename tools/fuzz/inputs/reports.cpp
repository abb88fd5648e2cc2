// Results that are read back: of the bench, of its limits, of campaigns; lists of a folder's results.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "hil/bench/report.h"
#include "hil/servo/servo_fit.h"
#include "host/motion/balance.h"
#include "tools/eval/episode_file.h"
#include "tools/eval/parts.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {

Complaint try_bench_report(Bytes bytes) {
  const auto report = hil::parse_bench_json(text_of(bytes), "case.json");
  if (!report) return judge_error(report.error(), "case.json");
  for (const hil::Measurement& one : report->measurements) {
    if (one.of == nullptr) return "an unknown measurement";
  }
  // Everything that a report is turned into.
  const std::string text = hil::bench_json(*report);
  const auto again = hil::parse_bench_json(text, "again");
  if (!again) return "written data cannot be read back: " + again.error().message;
  if (hil::bench_json(*again) != text) return "the report changes when it is written and read back";
  (void)hil::bench_csv(*report);
  (void)hil::bench_html(*report);
  (void)hil::bench_junit(*report);
  return std::nullopt;
}

Complaint try_bench_limits(Bytes bytes) {
  const auto limits = hil::parse_limits(text_of(bytes), "case.json");
  if (!limits) return judge_error(limits.error(), "case.json");
  for (const auto& [name, limit] : *limits) {
    if (hil::find_measurement(name) == nullptr) return "a limit of an unknown measurement";
    if (!(limit.first <= limit.second)) return "a lower limit exceeds its upper limit";
  }
  return std::nullopt;
}

Complaint try_balance(Bytes bytes) {
  const auto policy = motion::BalancePolicy::parse(text_of(bytes), "case.inc");
  if (!policy) return judge_error(policy.error(), "case.inc");
  const auto u = policy->evaluate(motion::BalancePolicy::Input::Constant(5));
  if (!u.allFinite() || u.cwiseAbs().maxCoeff() > 1) return "a correction is out of range";
  return std::nullopt;
}

Complaint try_servo_log(Bytes bytes) {
  const auto log = hil::parse_servo_log(text_of(bytes), "case.csv");
  if (!log) return judge_error(log.error(), "case.csv");
  if (log->samples.size() < 2 || !(log->load_kgm2() > 0)) return "an invalid pendulum";
  const std::string text = hil::servo_log_text(*log);
  // Times are written to the microsecond.
  if (const auto again = hil::parse_servo_log(text, "again");
      again && again->samples.size() != log->samples.size())
    return "the log changes when it is written and read back";
  const auto made = hil::predict(6, {}, *log);
  for (const double angle : made.position_rad)
    if (!std::isfinite(angle)) return "a position is not finite";
  return std::nullopt;
}

// What the summary takes for granted, field by field.
Complaint try_episodes(Bytes bytes) {
  const auto campaign = tools::parse_campaign(text_of(bytes), "case.json");
  if (!campaign) {
    if (auto wrong = judge_error(campaign.error(), "case.json")) return wrong;
  } else {
    (void)(*campaign)["behavior"].get<std::string>();
    if (*campaign != nlohmann::ordered_json(*campaign)) return "the campaign differs from its copy";
    (void)campaign->dump(2);
  }
  const auto result = tools::parse_result(text_of(bytes), "case.json");
  if (!result) {
    if (auto wrong = judge_error(result.error(), "case.json")) return wrong;
  } else {
    // What a merge makes of it: a sentence, and episodes that are not more than can be planned.
    const auto found = tools::find_shortage({tools::part_of("part", {}, *result)});
    if (found.extent.planned.episodes > 1'000'000) return "a plan has more than 1,000,000 episodes";
  }
  const auto episode = tools::parse_episode(text_of(bytes), "case.json");
  if (!episode) return judge_error(episode.error(), "case.json");
  const nlohmann::ordered_json& e = *episode;
  (void)e["episode"].get<std::uint64_t>();
  (void)e["success"].get<bool>();
  (void)(e["sentence"].get<std::string>() + e["cause"].get<std::string>());
  (void)e["scenario"]["seed"].dump();
  if (e.contains("rtf")) (void)e["rtf"].dump();
  (void)e["truth"].value("fell", false);
  if (e.contains("seconds") && !std::isfinite(e["seconds"].get<double>() * 0))
    return "the duration of an episode is not finite";
  for (const auto& [name, value] : e["measurements"].items()) {
    if (value.is_number()) (void)value.get<double>();
  }
  const auto again = tools::parse_episode(e.dump(1), "again");
  if (!again) return "written data cannot be read back: " + again.error().message;
  return std::nullopt;
}

}  // namespace kaz::fuzz
