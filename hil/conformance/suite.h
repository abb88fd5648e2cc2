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
  kMotion = 1,  // moves joints or motors
  kFlash = 2,   // writes flash, which wears out
  kBench = 4,   // requires a Bench (bench.h)
  kExact = 8,   // requires the board's own clock, which only a virtual board has
  // Requires a board at address 1. If RunOptions::address is 1, run_suite() sets this bit in `allowed`.
  kDefaultAddress = 16,
  // Requires a link that preserves pauses between bytes (RunOptions::whole_frames).
  kPauses = 32,
};

struct Case {
  std::string id;                       // id of the case, such as "frame.noise-before"
  std::string sentence;                 // the tested rule
  std::vector<std::string> statements;  // ids of the tested clauses
  unsigned needs = kNothing;
  std::function<void(Board&)> run;
};

// Returns all cases in the order in which they run. Ids are unique.
const std::vector<Case>& cases();

struct Statement {
  std::string id, text;
};
// Returns the clauses of docs/reference/protocol.md in the order of the page.
const std::vector<Statement>& statements();

struct CaseResult {
  const Case* of = nullptr;
  Verdict verdict = Verdict::passed;
  std::string message;                  // reason of a failure, skip or undecided verdict
  double seconds = 0;                   // duration on the board's clock
  std::vector<std::string> transcript;  // bytes of a failed or undecided case
  // Number of runs of the case. A failed run is repeated if a delay of this machine may have caused the
  // failure.
  int runs = 1;
};

struct RunOptions {
  std::string filter;  // regular expression for ids of cases or clauses; empty: all cases
  std::uint64_t seed = 1;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  unsigned allowed = 0;  // bits of Need that are available
  // True: the link transmits only whole frames, like a CAN bus. False: the cases that need kPauses also run.
  bool whole_frames = false;
  // Measures the delays of this machine; null for a virtual board. If such a delay may have caused the
  // failure of a case, the case is repeated. If all runs fail and this machine was late in each run, the case
  // is undecided.
  host::LatenessMeter* lateness = nullptr;
  std::function<void(const CaseResult&, std::size_t number, std::size_t of)> progress;
};

struct RunReport {
  // Description of the board, such as "Kaz servo board, protocol 3, firmware 0.2, build 1a2b3c4d".
  std::string board;
  std::vector<CaseResult> results;
  // Chosen cases that had not ended when the run was interrupted; empty if the run was not interrupted.
  std::vector<const Case*> not_run;
  // True if the run was interrupted. Then `results` contains the cases that had ended before the interrupt.
  bool interrupted = false;
  std::size_t chosen() const { return results.size() + not_run.size(); }
  int count(Verdict verdict) const;
};

// Returns the cases that the filter selects. Error (usage): the filter is not a regular expression or
// matches no case.
Result<std::vector<const Case*>> chosen(const std::string& filter);

// Runs the chosen cases. Returns the errors of chosen(). Other errors (environment): the link is lost; the
// board does not answer or stops answering. If a call of `link` or `clock` is interrupted, the run ends,
// and run_suite() returns the report.
Result<RunReport> run_suite(host::Link& link, host::Clock& clock, Bench* bench, Time slack,
                            const RunOptions& options);

// Returns the reason why a case is left out, such as "needs --allow-motion". `missing` contains the unmet
// requirements of the case, as Need bits.
std::string missing_text(unsigned missing);

// List of cases. Each function below adds the cases of one chapter of docs/reference/protocol.md.
using Cases = std::vector<Case>;

// Adds the cases of a chapter. The ids of the cases begin with the name of the chapter. Each case has the
// requirements `needs` unless other requirements are passed to add().
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
