// The cases of the conformance suite, and how to run them.
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

// Requirements of a case, in addition to a link.
enum Need : unsigned {
  kNothing = 0,
  kMotion = 1,           // moves joints or motors
  kFlash = 2,            // writes flash, which wears out
  kBench = 4,            // a Bench (bench.h)
  kExact = 8,            // a clock without slack
  kDefaultAddress = 16,  // a board at address 1; set by run_suite()
  kPauses = 32,          // a line that preserves pauses between bytes (RunOptions::whole_frames)
};

struct Case {
  std::string id;                       // "frame.noise-before"
  std::string sentence;                 // tested rule
  std::vector<std::string> statements;  // clause ids of docs/reference/protocol.md
  unsigned needs = kNothing;
  std::function<void(Board&)> run;
};

// Returns all cases in the order in which they run. Ids are unique.
const std::vector<Case>& cases();

struct Statement {
  std::string id, text;
};
// Returns the clauses of docs/reference/protocol.md, in its order.
const std::vector<Statement>& statements();

struct CaseResult {
  const Case* of = nullptr;
  Verdict verdict = Verdict::passed;
  std::string message;                  // reason of a failure, skip or undecided verdict
  double seconds = 0;                   // duration on the board's clock
  std::vector<std::string> transcript;  // bytes of a failed or undecided case
  int runs = 1;                         // all but the last failed while this machine was late
};

struct RunOptions {
  std::string filter;  // regular expression for case or clause ids; empty: all
  std::uint64_t seed = 1;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  unsigned allowed = 0;  // bits of Need that are available
  // The link carries whole frames only, as a CAN bus does. kPauses is available if this is false.
  bool whole_frames = false;
  // Lateness of link and clock, if link and clock are real; may be null. A case that fails while this
  // machine is late is repeated. The case is undecided if the machine was late in each run.
  host::LatenessMeter* lateness = nullptr;
  std::function<void(const CaseResult&, std::size_t number, std::size_t of)> progress;
};

struct RunReport {
  std::string board;  // "Kaz servo board, protocol 3, firmware 0.2, build 1a2b3c4d"
  std::vector<CaseResult> results;
  // Chosen cases that an interrupted run did not reach.
  std::vector<const Case*> not_run;
  bool interrupted = false;  // the run was interrupted; `results` are the results until then
  std::size_t chosen() const { return results.size() + not_run.size(); }
  int count(Verdict verdict) const;
};

// Returns the cases that the filter selects. Error (usage): the filter is not a regular expression or
// matches no case.
Result<std::vector<const Case*>> chosen(const std::string& filter);

// Runs the chosen cases. Errors: those of chosen(); the link is gone, or the board does not answer or stops
// answering (environment). An interrupted link or clock ends the run, and the report so far is returned.
Result<RunReport> run_suite(host::Link& link, host::Clock& clock, Bench* bench, Time slack,
                            const RunOptions& options);

// Returns the reason for leaving out a case with these unmet Need bits: "needs --allow-motion".
std::string missing_text(unsigned missing);

// Cases, added by chapter of the page.
using Cases = std::vector<Case>;

// Adds the cases of a chapter. The ids of the cases begin with the name of the chapter. Each case has the
// requirements `needs` unless others are given.
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
