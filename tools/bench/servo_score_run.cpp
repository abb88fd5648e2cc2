// Fits a servo to a part of its logs, and scores the model on the other part.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/servo_score_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include <nlohmann/json.hpp>

#include "host/link/interrupt.h"
#include "shared/base/number_text.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/provenance.h"
#include "tools/bench/servo_identity.h"
#include "tools/bench/servo_replay.h"
#include "tools/bench/servo_report.h"
#include "tools/bench/servo_run.h"

namespace kaz::tools {
namespace {

using hil::ServoLog;
using Json = nlohmann::ordered_json;

const OutputKind& servo_score_output() {
  static const OutputKind kind{"bench servo-score",
                               {"scores.csv", "tables.md", "replay.csv", "result.json"}};
  return kind;
}

struct Split {
  std::string name;
  double ServoLog::*by;
  std::vector<double> values;  // logs with these values are held out
};

bool holds_out(const Split& split, const ServoLog& log) {
  return std::ranges::any_of(
      split.values, [&](double value) { return std::abs(log.*split.by - value) <= 0.01 * value; });
}

// The splits that one option asks for; several for a cross-validation.
Result<std::vector<Split>> splits_of(const std::string& text, const std::vector<ServoLog>& logs) {
  const auto wrong = [&text] {
    return fail(Fault::usage, "--hold-out " + text +
                                  ": must be gain, mass, gain=VALUE,VALUE or mass=VALUE,VALUE");
  };
  const std::size_t sign = text.find('=');
  const std::string key = text.substr(0, sign);
  if (key != "gain" && key != "mass") return wrong();
  Split split{text, key == "gain" ? &ServoLog::gain_per_rad : &ServoLog::mass_kg, {}};
  std::vector<Split> all;
  if (sign == std::string::npos) {
    std::set<double> values;
    for (const ServoLog& log : logs) values.insert(log.*split.by);
    for (const double value : values) {
      char name[60];
      std::snprintf(name, sizeof name, "%s=%.4g", key.c_str(), value);
      all.push_back({name, split.by, {value}});
    }
    return all;
  }
  for (std::size_t at = sign; at != std::string::npos;) {
    const std::size_t end = text.find(',', at + 1);
    const auto value = parse_number<double>(text.substr(at + 1, end - at - 1));
    if (!value || !(*value > 0)) return wrong();
    split.values.push_back(*value);
    at = end;
  }
  all.push_back(split);
  return all;
}

struct SplitScore {
  std::string name;
  ServoResult result;
  std::vector<ReplayedLog> replayed = {};
};

Result<SplitScore> scored(const Split& split, const std::vector<ServoLog>& logs,
                          const hil::ServoFitOptions& options, const std::string& replay) {
  SplitScore score{split.name, {}};
  for (const ServoLog& log : logs)
    (holds_out(split, log) ? score.result.held_out : score.result.logs).push_back(log);
  if (score.result.logs.empty() || score.result.held_out.empty())
    return fail(Fault::usage, "--hold-out " + split.name + ": holds out " +
                                  std::to_string(score.result.held_out.size()) + " of " +
                                  std::to_string(logs.size()) +
                                  " logs: must hold out at least one log and leave one to fit");
  score.result.fits = KAZ_TRY(hil::fit_servo(score.result.logs, score.result.held_out, options));
  KAZ_TRY(judge_servo(score.result, options));
  if (!replay.empty())
    score.replayed = KAZ_TRY(replay_logs(identified_servo(score.result, replay),
                                         score.result.best(), score.result.held_out));
  return score;
}

std::string in_mrad(double rad) {
  if (std::isnan(rad)) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.1f", 1e3 * rad);
  return text;
}

using Table = std::vector<std::vector<std::string>>;

void add_groups(Table& rows, const std::vector<std::string>& start, const hil::ServoScore& score,
                const std::string& prefix) {
  for (const hil::GroupScore& group : score.groups) {
    rows.push_back(start);
    for (const std::string& cell :
         {prefix + group.kind, group.name, std::to_string(group.logs), in_mrad(group.error_rad),
          in_mrad(group.trimmed_rad), in_mrad(group.floor_rad)})
      rows.back().push_back(cell);
  }
}

Table table_of(const std::vector<SplitScore>& scores) {
  Table rows{{"held_out", "model", "group", "name", "logs", "error_mrad", "without_strays_mrad",
              "repeatability_mrad"}};
  for (const SplitScore& one : scores) {
    const std::string best = "M" + std::to_string(one.result.best().model);
    for (const hil::ServoFit& fit : one.result.fits)
      rows.push_back({one.name, "M" + std::to_string(fit.model), "model", "all logs",
                      std::to_string(one.result.held_out.size()),
                      in_mrad(fit.held_out.position_rad), "", ""});
    for (const hil::ServoFit& fit : one.result.fits)
      if (std::isfinite(fit.inner_rad))
        rows.push_back({one.name, "M" + std::to_string(fit.model), "model", "inner splits", "",
                        in_mrad(fit.inner_rad), "", ""});
    add_groups(rows, {one.name, best}, one.result.score, "");
    add_groups(rows, {one.name, best}, one.result.own_zeros_score, "own zeros, ");
  }
  return rows;
}

Table replay_table(const std::vector<SplitScore>& scores) {
  Table rows{{"held_out", "log", "fit_mrad", "replay_mrad", "distance_mrad"}};
  for (const SplitScore& score : scores) {
    ReplayedLog mean{"all logs"};
    const auto add = [&](const ReplayedLog& one) {
      rows.push_back({score.name, one.name, in_mrad(one.fit_rad), in_mrad(one.replay_rad),
                      in_mrad(one.distance_rad)});
    };
    for (const ReplayedLog& one : score.replayed) {
      add(one);
      for (double ReplayedLog::*at :
           {&ReplayedLog::fit_rad, &ReplayedLog::replay_rad, &ReplayedLog::distance_rad})
        mean.*at += one.*at / static_cast<double>(score.replayed.size());
    }
    add(mean);
  }
  return rows;
}

std::string csv(const Table& rows) {
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool quoted = row[i].find_first_of(",\"") != std::string::npos;
      text += (i > 0 ? "," : "") + (quoted ? '"' + row[i] + '"' : row[i]);
    }
    text += "\n";
  }
  return text;
}

std::string markdown(const Table& rows) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::string& cell : rows[i]) text += "| " + cell + " ";
    text += "|\n";
    for (std::size_t k = 0; i == 0 && k < rows[0].size(); ++k) text += "|---";
    if (i == 0) text += "|\n";
  }
  return text;
}

}  // namespace

Result<bool> run_servo_score(const ServoScoreArguments& arguments) {
  const auto logs = KAZ_TRY(read_servo_logs(arguments.logs));
  std::vector<Split> splits;
  for (const std::string& text : arguments.splits)
    for (Split& one : KAZ_TRY(splits_of(text, logs))) splits.push_back(std::move(one));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto folder = KAZ_TRY(OutputFolder::open(arguments.out, servo_score_output()));
  Progress progress("kaz bench servo-score", arguments.json);
  hil::ServoFitOptions options;
  if (arguments.model > 0) options.models.resize(static_cast<std::size_t>(arguments.model));
  options.stopped = [&] { return interrupt.requested(); };
  std::vector<SplitScore> scores;
  for (const Split& split : splits) {
    options.progress = [&](double share, const std::string& what) {
      progress.update(
          (static_cast<double>(scores.size()) + share) / static_cast<double>(splits.size()),
          split.name + ", " + what);
    };
    scores.push_back(KAZ_TRY(scored(split, logs, options, arguments.replay)));
  }
  progress.done();
  Json json;
  for (const SplitScore& one : scores) {
    json["splits"].push_back(servo_json(one.result));
    json["splits"].back()["name"] = one.name;
    for (const ReplayedLog& log : one.replayed)
      json["splits"].back()["replay"].push_back({{"log", log.name},
                                                 {"fit_rad", log.fit_rad},
                                                 {"replay_rad", log.replay_rad},
                                                 {"distance_rad", log.distance_rad}});
  }
  json["provenance"] = provenance_json();
  const Table rows = table_of(scores);
  KAZ_TRY(folder.clear());
  KAZ_TRY(folder.write("scores.csv", csv(rows)));
  KAZ_TRY(folder.write("tables.md", markdown(rows)));
  const Table replayed = replay_table(scores);
  if (!arguments.replay.empty()) KAZ_TRY(folder.write("replay.csv", csv(replayed)));
  KAZ_TRY(folder.write_json("result.json", json));
  if (arguments.json)
    print_json(json);
  else
    std::printf("%s%sthe tables are in %s\n", markdown(rows).c_str(),
                arguments.replay.empty() ? "" : ("\n" + markdown(replayed)).c_str(),
                folder.folder().c_str());
  return true;
}

}  // namespace kaz::tools
