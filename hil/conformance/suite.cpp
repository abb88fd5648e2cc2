// Runs the cases, each from a known state, and leaves the board safe.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"

#include <algorithm>
#include <cstdio>
#include <regex>

namespace kaz::hil {

void Chapter::add(const std::string& id, std::string sentence, std::string statement,
                  std::function<void(Board&)> run, unsigned needs) {
  all_.push_back(
      {name_ + "." + id, std::move(sentence), {std::move(statement)}, needs, std::move(run)});
}

namespace {

Cases all_cases() {
  Cases all;
  add_frame_cases(all);
  add_address_cases(all);
  add_request_cases(all);
  add_table_cases(all);
  add_identity_cases(all);
  add_motion_cases(all);
  add_limit_cases(all);
  add_settings_cases(all);
  add_safety_cases(all);
  add_watchdog_cases(all);
  add_telemetry_cases(all);
  add_calibration_cases(all);
  add_bench_cases(all);
  add_timing_cases(all);
  return all;
}

std::string describe(Board& board) {
  const Reply who = board.done("identify");
  char text[120];
  std::snprintf(text, sizeof text, "Kaz servo board, protocol %ld, firmware %ld.%ld, build %08lx",
                who["protocol_version"], who["firmware_version"] >> 8,
                who["firmware_version"] & 0xFF, static_cast<unsigned long>(who["build_id"]));
  return text;
}

// A case's own random numbers, the same whichever others run.
std::uint64_t seed_of(const std::string& id) {
  std::uint64_t seed = 14695981039346656037u;
  for (const char c : id) seed = (seed ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return seed;
}

CaseResult run_once(const Case& one, Board& board, unsigned allowed) {
  CaseResult result;
  result.of = &one;
  if (const unsigned missing = one.needs & ~allowed; missing != 0) {
    result.verdict = Verdict::left_out;
    result.message = missing_text(missing);
    return result;
  }
  const Time started = board.now();
  try {
    board.begin(seed_of(one.id));
    one.run(board);
  } catch (const Failed& failed) {
    result.verdict = Verdict::failed;
    result.message = failed.message;
    result.transcript = board.transcript();
  }
  result.seconds = seconds(board.now() - started);
  board.end();
  return result;
}

// Of a board that has lost its power or its cable, every later case would fail.
Error stopped_answering(const host::Link& link, const Case& one) {
  return {Fault::environment,
          "the board on " + link.name() + " stopped answering during case " + one.id +
              " and no longer answers at any address; check its power and cable"};
}

CaseResult run_one(const Case& one, Board& board, const host::Link& link,
                   const RunOptions& options) {
  for (int run = 1;; ++run) {
    if (options.lateness) options.lateness->begin();
    CaseResult result = run_once(one, board, options.allowed);
    result.runs = run;
    if (result.verdict != Verdict::failed) return result;
    const bool gone = board.gone();
    const std::string excuse = options.lateness ? options.lateness->excuse() : "";
    if (options.lateness && options.lateness->other_end_gone())
      throw Lost{{Fault::environment, excuse + "; case " + one.id + " is not decided"}};
    if (!excuse.empty() && run <= host::LatenessMeter::kRepetitions) continue;
    if (gone) throw Lost{stopped_answering(link, one)};
    if (excuse.empty()) return result;
    result.verdict = Verdict::undecided;
    result.message += "; but " + excuse + " (late in all " + std::to_string(run) + " runs)";
    return result;
  }
}

}  // namespace

const std::vector<Case>& cases() {
  static const Cases all = all_cases();
  return all;
}

const std::vector<Statement>& statements() {
  static const std::vector<Statement> all = {
#define KZ_STATEMENT(id, text) {id, text},
#include "kz_statements.h"
#undef KZ_STATEMENT
  };
  return all;
}

std::string missing_text(unsigned missing) {
  std::string text;
  const auto add = [&](unsigned need, const char* what) {
    if (missing & need) text += (text.empty() ? "needs " : " and ") + std::string(what);
  };
  add(kMotion, "--allow-motion");
  add(kFlash, "--allow-flash");
  add(kBench, "a bench that can disturb supply, sensors and line");
  add(kExact, "the board's own clock");
  add(kDefaultAddress, "a board with the default address 1");
  add(kPauses, "a link that preserves pauses between bytes");
  return text;
}

int RunReport::count(Verdict verdict) const {
  return static_cast<int>(std::count_if(results.begin(), results.end(), [&](const CaseResult& one) {
    return one.verdict == verdict;
  }));
}

Result<std::vector<const Case*>> chosen(const std::string& filter) {
  std::vector<const Case*> taken;
  try {
    const std::regex pattern(filter);
    for (const Case& one : cases()) {
      bool found = std::regex_search(one.id, pattern);
      for (const std::string& id : one.statements) found |= std::regex_search(id, pattern);
      if (found) taken.push_back(&one);
    }
  } catch (const std::regex_error& wrong) {
    return fail(Fault::usage,
                "--filter " + filter + " is not a regular expression: " + wrong.what());
  }
  if (taken.empty()) {
    return fail(Fault::usage, "--filter " + filter +
                                  " matches no case; `kaz conformance --list` lists the cases");
  }
  return taken;
}

Result<RunReport> run_suite(host::Link& link, host::Clock& clock, Bench* bench, Time slack,
                            const RunOptions& options) {
  const auto taken = KAZ_TRY(chosen(options.filter));
  RunReport report;
  Board board(link, clock, bench, slack, options.seed, options.address);
  RunOptions of_case = options;
  if (options.address == KZ_ADDRESS_DEFAULT) of_case.allowed |= kDefaultAddress;
  if (!options.whole_frames) of_case.allowed |= kPauses;
  try {
    board.begin(0);
    report.board = describe(board);
    for (const Case* one : taken) {
      report.results.push_back(run_one(*one, board, link, of_case));
      if (options.progress) {
        options.progress(report.results.back(), report.results.size(), taken.size());
      }
    }
  } catch (const Lost& lost) {
    if (lost.error.fault != Fault::interrupted) return tl::unexpected(lost.error);
    report.interrupted = true;
    report.not_run.assign(taken.begin() + static_cast<std::ptrdiff_t>(report.results.size()),
                          taken.end());
  } catch (const Failed& failed) {
    return fail(Fault::environment,
                "no Kaz board answers on " + link.name() + ": " + failed.message);
  }
  return report;
}

}  // namespace kaz::hil
