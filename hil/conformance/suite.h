// The cases of the conformance suite, and how they are run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "hil/conformance/board.h"
#include "hil/report/verdict.h"
#include "host/link/lateness.h"

namespace kaz::hil {

// What a case needs besides a link.
enum Need : unsigned {
  kNothing = 0,
  kMotion = 1,           // joints or motors move
  kFlash = 2,            // writes flash, whose life is finite
  kBench = 4,            // Bench
  kExact = 8,            // a clock without slack
  kDefaultAddress = 16,  // a board at address 1; run_suite() knows
  kPauses = 32,          // a line on which pauses between bytes arrive; RunOptions::whole_frames
};

struct Case {
  std::string id;                       // "frame.noise-before"
  std::string sentence;                 // what it shows
  std::vector<std::string> statements;  // of docs/reference/protocol.md
  unsigned needs = kNothing;
  std::function<void(Board&)> run;
};

// All cases, in the order in which they run. Ids are unique.
const std::vector<Case>& cases();

struct Statement {
  std::string id, text;
};
// Those of docs/reference/protocol.md, in its order.
const std::vector<Statement>& statements();

struct CaseResult {
  const Case* of = nullptr;
  Verdict verdict = Verdict::passed;
  std::string message;                  // why it failed, was skipped, or could not be judged
  double seconds = 0;                   // on the board's clock
  std::vector<std::string> transcript;  // of a failed or undecided one
  int runs = 1;                         // more: the earlier ones failed while this machine was late
};

struct RunOptions {
  std::string filter;  // regular expression, found anywhere in id or statement; empty: all
  std::uint64_t seed = 1;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  unsigned allowed = 0;  // Need, those that are to be had
  // The link carries whole frames only, as a CAN bus does: kPauses is not to be had, else it is.
  bool whole_frames = false;
  // The link and the clock of the run, where they are real: a case that fails while this machine is
  // late is repeated, and undecided if it was late each time.
  host::LatenessMeter* lateness = nullptr;
  std::function<void(const CaseResult&, std::size_t number, std::size_t of)> progress;
};

struct RunReport {
  std::string board;  // "Kaz servo board, protocol 3, firmware 0.2, build 1a2b3c4d"
  std::vector<CaseResult> results;
  std::vector<const Case*>
      not_run;               // what the filter took beyond the results, of a run that broke off
  bool interrupted = false;  // the results are of the cases before
  std::size_t chosen() const { return results.size() + not_run.size(); }
  int count(Verdict verdict) const;
};

// The cases that the filter takes. Error: usage, if it is no regular expression or takes none.
Result<std::vector<const Case*>> chosen(const std::string& filter);

// Runs them one after the other. Errors: the link is gone or nothing answers, also from some case on
// (environment). An interrupted link or clock ends it with the report until then.
Result<RunReport> run_suite(host::Link& link, host::Clock& clock, Bench* bench, Time slack,
                            const RunOptions& options);

// What is `given` when one is missing: "needs --allow-motion".
std::string missing_text(unsigned missing);

// Where the cases stand, by chapter of the page.
using Cases = std::vector<Case>;

// Adds a chapter's cases: their ids begin with its name, and they need `needs` unless they say otherwise.
class Chapter {
 public:
  Chapter(Cases& all, std::string name, unsigned needs)
      : all_(all), name_(std::move(name)), needs_(needs) {}
  void add(const std::string& id, std::string sentence, std::string statement,
           std::function<void(Board&)> run) {
    add(id, std::move(sentence), std::move(statement), std::move(run), needs_);
  }
  void add(const std::string& id, std::string sentence, std::string statement,
           std::function<void(Board&)> run, unsigned needs);

 private:
  Cases& all_;
  std::string name_;
  unsigned needs_;
};

void add_frame_cases(Cases& all);
void add_address_cases(Cases& all);
void add_request_cases(Cases& all);
void add_table_cases(Cases& all);
void add_identity_cases(Cases& all);
void add_motion_cases(Cases& all);
void add_limit_cases(Cases& all);
void add_settings_cases(Cases& all);
void add_safety_cases(Cases& all);
void add_watchdog_cases(Cases& all);
void add_telemetry_cases(Cases& all);
void add_calibration_cases(Cases& all);
void add_bench_cases(Cases& all);
void add_timing_cases(Cases& all);

}  // namespace kaz::hil
