// Rates, intervals and causes out of the episodes of a campaign.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/summary.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <vector>

#include "hil/report/junit.h"
#include "hil/report/provenance.h"
#include "shared/base/one_line.hpp"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/eval/breakdown.h"
#include "tools/eval/campaign.h"
#include "tools/trials/statistics.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;
using trials::quantile;

// Median and spread of every result that successful episodes reported.
Json measurements_json(const Episodes& episodes) {
  std::map<std::string, std::vector<double>> all;
  for (const auto& [number, episode] : episodes) {
    if (!episode["success"].get<bool>()) continue;
    for (const auto& [name, value] : episode["measurements"].items())
      if (value.is_number()) all[name].push_back(value.get<double>());
  }
  Json json = Json::object();
  for (const auto& [name, values] : all) {
    json[name] = {{"median", quantile(values, 0.5)},
                  {"p5", quantile(values, 0.05)},
                  {"p95", quantile(values, 0.95)}};
  }
  return json;
}

std::string table(const Episodes& episodes) {
  std::string text = "episode,seed,success,claim,cause,seconds,rtf,sentence\n";
  for (const auto& [number, e] : episodes) {
    std::string sentence = one_line(e["sentence"].get<std::string>());
    std::replace(sentence.begin(), sentence.end(), '"', '\'');
    text += std::to_string(number) + "," + e["scenario"]["seed"].dump() + "," +
            (e["success"].get<bool>() ? "1," : "0,") +
            (!e.contains("claim")     ? ","
             : e["claim"].get<bool>() ? "1,"
                                      : "0,") +
            one_line(e["cause"].get<std::string>()) + "," +
            (e.contains("seconds") ? e["seconds"].dump() : "") + "," +
            (e.contains("rtf") ? e["rtf"].dump() : "") + ",\"" + sentence + "\"\n";
  }
  return text;
}

// How often claim and truth agreed, of the episodes that truth decided.
Json claims_json(const Episodes& episodes) {
  std::uint64_t judged = 0;
  Json claimed = Json::array(), unclaimed = Json::array();
  for (const auto& [number, e] : episodes) {
    if (!e.contains("claim") || !e.value("judged", true)) continue;
    ++judged;
    const bool claim = e["claim"].get<bool>(), success = e["success"].get<bool>();
    if (claim && !success) claimed.push_back(number);
    if (!claim && success) unclaimed.push_back(number);
  }
  if (judged == 0) return Json();
  return {{"judged", judged},
          {"agreed", judged - claimed.size() - unclaimed.size()},
          {"claimed_without_success", claimed},
          {"success_without_claim", unclaimed}};
}

// A case for each episode.
std::string junit(const Json& result, const Episodes& episodes, const LostEpisodes& lost,
                  const Extent& extent) {
  const std::string behavior = result["campaign"]["behavior"].get<std::string>();
  hil::JunitSuite::Counts counts;
  double seconds = 0;
  for (const auto& [number, e] : episodes) {
    ++(e["success"].get<bool>() ? counts.passed : counts.failed);
    seconds += e.contains("seconds") ? e["seconds"].get<double>() : 0;
  }
  counts.errors = static_cast<int>(lost.size()) + (extent.interrupted ? 1 : 0);
  hil::JunitSuite suite("kaz evaluate " + behavior, counts, seconds);
  for (const auto& [name, value] : hil::provenance_properties(provenance()))
    suite.property(name, value);
  if (result.contains("claims")) {
    suite.property("claims_judged", result["claims"]["judged"].dump());
    suite.property("claims_agreed", result["claims"]["agreed"].dump());
  }
  const auto name_of = [](std::uint64_t number) { return "episode " + std::to_string(number); };
  for (const auto& [number, e] : episodes) {
    const bool success = e["success"].get<bool>();
    hil::JunitCase one;
    one.group = behavior;
    one.name = name_of(number);
    one.verdict = success ? hil::Verdict::passed : hil::Verdict::failed;
    if (e.contains("seconds")) one.seconds = e["seconds"].get<double>();
    const std::string sentence = e["sentence"].get<std::string>();
    if (!success) one.message = e["cause"].get<std::string>() + ": " + sentence;
    if (e.contains("claim"))
      one.output = std::string("the behavior claims ") +
                   (e["claim"].get<bool>() ? "success: " : "failure: ") + sentence;
    suite.add(one);
  }
  for (const auto& [number, sentence] : lost) suite.add_error(behavior, name_of(number), sentence);
  if (extent.interrupted)
    suite.add_error(behavior, "evaluation",
                    "interrupted" + (extent.signal.empty() ? "" : " by " + extent.signal));
  return suite.finish();
}

// How many pushes the episodes had, with a `note` where some had none; null without any to have.
Json pushes_json(const Json& campaign, const Episodes& episodes) {
  std::vector<double> counts;
  std::size_t none = 0, without_step = 0;
  for (const auto& [number, e] : episodes) {
    const auto count = e.find("pushes");
    if (count == e.end() || !count->is_number()) continue;
    counts.push_back(count->get<double>());
    if (counts.back() > 0) continue;
    ++none;
    if (!e.contains("walked_s")) ++without_step;
  }
  if (counts.empty()) return nullptr;
  Json json{{"median", quantile(counts, 0.5)}, {"least", *std::ranges::min_element(counts)}};
  if (none == 0) return json;
  json["episodes_without"] = none;
  const Json requested = campaign.value("pushes", Json::object());
  const std::string since = requested.value("since", "start");
  if (since == "start") without_step = 0;
  std::string note =
      std::to_string(none) + " of " + std::to_string(counts.size()) + " episodes had no push";
  char from[24];
  std::snprintf(from, sizeof from, "%g", requested.value("from_s", 0.0));
  if (none > without_step)
    note += "; " + std::to_string(none - without_step) + " ended within " + from + " s of the " +
            since + ": give a smaller --push-from";
  if (without_step > 0)
    note += "; without a first step of the robot, no push is scheduled (such episodes: " +
            std::to_string(without_step) + "): see the causes in episodes.csv";
  json["note"] = note;
  return json;
}

void print(const Json& result, const OutputFolder& folder) {
  const double n = result["episodes"].get<double>();
  std::printf("%s: %.0f of %.0f succeeded",
              result["campaign"]["behavior"].get<std::string>().c_str(),
              result["successes"].get<double>(), n);
  if (n > 0)
    std::printf(
        ", %.1f %% (95 %% interval %.1f to %.1f)", 100 * result["success_rate"].get<double>(),
        100 * result["interval"][0].get<double>(), 100 * result["interval"][1].get<double>());
  char seconds[80] = "", rtf[40] = "";
  if (result.contains("seconds"))
    std::snprintf(seconds, sizeof seconds, "; robot time: median %.1f s, 95th percentile %.1f s",
                  result["seconds"]["median"].get<double>(),
                  result["seconds"]["p95"].get<double>());
  if (result.contains("rtf_median"))
    std::snprintf(rtf, sizeof rtf, "; %.1f x real time", result["rtf_median"].get<double>());
  print_lines("\nfalls %llu%s%s\n", result["falls"].get<unsigned long long>(), seconds, rtf);
  if (const auto pushes = result.find("pushes"); pushes != result.end()) {
    std::printf("pushes per episode: median %.0f, minimum %.0f\n",
                (*pushes)["median"].get<double>(), (*pushes)["least"].get<double>());
    if (pushes->contains("note"))
      print_lines("note: %s\n", (*pushes)["note"].get<std::string>().c_str());
  }
  for (const auto& [cause, numbers] : result["failures"].items()) {
    std::string episodes;
    for (std::size_t i = 0; i < std::min<std::size_t>(numbers.size(), 12); ++i)
      episodes += " " + std::to_string(numbers[i].get<unsigned long long>());
    print_lines("  %-24s %3zu  episodes%s%s\n", cause.c_str(), numbers.size(), episodes.c_str(),
                numbers.size() > 12 ? " ..." : "");
  }
  if (result.contains("claims")) print_lines("%s\n", claims_text(result["claims"]).c_str());
  if (const auto by = result.find("by"); by != result.end())
    std::printf("%s", breakdown_text(*by).c_str());
  for (const Json& one : result["environment"])
    print_lines("  undecided, lost to a machine error: episode %llu: %s\n",
                one["episode"].get<unsigned long long>(),
                one["sentence"].get<std::string>().c_str());
  if (!result["failures"].empty())
    std::printf("recordings of the failures are in %s\n", folder.path("failures").c_str());
  std::printf("result.json, report.html, junit.xml and episodes.csv are in %s\n",
              folder.folder().c_str());
}

// Marked as all interrupted results are (mark_interrupted()), but the signal may have been a part's.
void add_extent(Json& result, const Extent& extent) {
  const Planned& planned = extent.planned;
  if (planned.episodes > 0)
    result["planned"] = {
        {"episodes", planned.episodes}, {"shard", planned.shard}, {"shards", planned.shards}};
  if (!extent.missing.empty()) result["missing"] = extent.missing;
  if (extent.interrupted) result["interrupted"] = true;
  if (!extent.signal.empty()) result["signal"] = extent.signal;
}

}  // namespace

Result<bool> summarize(const Json& campaign, const Episodes& episodes, const LostEpisodes& lost,
                       const OutputFolder& folder, bool json, const Extent& extent) {
  std::uint64_t successes = 0, falls = 0;
  std::optional<std::int64_t> unconverged_steps;
  std::vector<double> times, speeds;
  Json failures = Json::object();
  for (const auto& [number, e] : episodes) {
    const std::string cause = e["cause"].get<std::string>();
    if (e["success"].get<bool>()) {
      ++successes;
    } else {
      if (!failures.contains(cause)) failures[cause] = Json::array();
      failures[cause].push_back(number);
    }
    if (e["truth"].value("fell", false)) ++falls;
    if (const auto steps = e["truth"].find("unconverged_steps");
        steps != e["truth"].end() && steps->is_number_integer())
      unconverged_steps = unconverged_steps.value_or(0) + steps->get<std::int64_t>();
    if (e.contains("seconds")) times.push_back(e["seconds"].get<double>());
    if (e.contains("rtf")) speeds.push_back(e["rtf"].get<double>());
  }
  Json environment = Json::array();
  for (const auto& [number, sentence] : lost)
    environment.push_back({{"episode", number}, {"sentence", sentence}});
  const auto n = static_cast<std::uint64_t>(episodes.size());
  const Interval interval = trials::wilson(successes, n);
  Json result = Json::object();
  if (n > 0) {
    result["success_rate"] = static_cast<double>(successes) / static_cast<double>(n);
    result["interval"] = {interval.min, interval.max};
  }
  result["episodes"] = n;
  result["successes"] = successes;
  result["falls"] = falls;
  if (unconverged_steps) result["unconverged_steps"] = *unconverged_steps;
  if (!times.empty())
    result["seconds"] = {{"median", quantile(times, 0.5)}, {"p95", quantile(times, 0.95)}};
  if (!speeds.empty()) result["rtf_median"] = quantile(speeds, 0.5);
  if (Json pushes = pushes_json(campaign, episodes); !pushes.is_null())
    result["pushes"] = std::move(pushes);
  result["failures"] = failures;
  result["environment"] = environment;
  if (Json claims = claims_json(episodes); !claims.is_null()) result["claims"] = std::move(claims);
  if (Json by = breakdown_json(episodes); !by.empty()) result["by"] = std::move(by);
  result["measurements"] = measurements_json(episodes);
  result["campaign"] = campaign;
  result["provenance"] = provenance_json();
  add_extent(result, extent);
  if (json) print_json(result);
  KAZ_TRY(folder.write("episodes.csv", table(episodes)));
  KAZ_TRY(folder.write("report.html", evaluation_page(result, episodes)));
  KAZ_TRY(folder.write("junit.xml", junit(result, episodes, lost, extent)));
  KAZ_TRY(folder.write_json("result.json", result));
  if (!json) print(result, folder);
  return successes > 0;
}

}  // namespace kaz::tools
