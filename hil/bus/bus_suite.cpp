// Runs the cases at a servo, and leaves it as it was.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bus/bus_suite.h"

#include <algorithm>
#include <optional>
#include <regex>

namespace kaz::hil {
namespace {

std::vector<ServoCase> all_cases(ServoFamily family) {
  std::vector<ServoCase> all;
  family == ServoFamily::feetech ? add_feetech_cases(all) : add_dynamixel_cases(all);
  return all;
}

// Puts back what a case has changed, although the program was interrupted.
Result<void> leave(ExaminedServo& servo, bool moves, host::Interrupt* interrupt) {
  constexpr std::chrono::milliseconds kLongest{5000};
  try {
    std::optional<host::CleanUp> clean_up;
    if (interrupt != nullptr) clean_up.emplace(*interrupt, kLongest);
    servo.end_case(moves);
  } catch (const Failed& failed) {
    return fail(Fault::environment, servo.title() + ": " + failed.message);
  } catch (const Lost& lost) {
    return fail(lost.error.fault, servo.title() +
                                      ": its torque is not confirmed to be off: cut its power (" +
                                      lost.error.message + ")");
  }
  return {};
}

CaseResult run_once(const ServoCase& one, ExaminedServo& servo, unsigned allowed) {
  CaseResult result;
  result.of = &one.of;
  unsigned missing = one.needs & ~allowed;
  if (missing == 0 && one.has && !one.has(servo.table(), servo.firmware())) missing = kServoModel;
  if (missing != 0) {
    result.verdict = Verdict::left_out;
    result.message = missing_servo_text(missing);
    return result;
  }
  const auto failed = [&](const std::string& message) {
    if (result.verdict == Verdict::failed) {
      result.message += "; " + message;
      return;
    }
    result.verdict = Verdict::failed;
    result.message = message;
  };
  servo.begin_case();
  try {
    one.run(servo);
  } catch (const Failed& wrong) {
    failed(wrong.message);
  }
  try {
    servo.end_case((one.needs & kServoMotion) != 0);
  } catch (const Failed& wrong) {
    failed(wrong.message);
  }
  if (result.verdict == Verdict::failed) result.transcript = servo.transcript();
  return result;
}

CaseResult run_one(const ServoCase& one, ExaminedServo& servo, const BusRunOptions& options) {
  for (int run = 1;; ++run) {
    if (options.lateness) options.lateness->begin();
    CaseResult result = run_once(one, servo, options.allowed);
    result.runs = run;
    if (result.verdict != Verdict::failed || !options.lateness) return result;
    const std::string excuse = options.lateness->excuse();
    if (excuse.empty()) return result;
    if (run <= host::LatenessMeter::kRepetitions) continue;
    result.verdict = Verdict::undecided;
    result.message += "; but " + excuse + " (late in all " + std::to_string(run) + " runs)";
    return result;
  }
}

}  // namespace

const std::vector<ServoCase>& servo_cases(ServoFamily family) {
  static const std::vector<ServoCase> feetech = all_cases(ServoFamily::feetech),
                                      dynamixel = all_cases(ServoFamily::dynamixel);
  return family == ServoFamily::feetech ? feetech : dynamixel;
}

std::string missing_servo_text(unsigned missing) {
  std::string text;
  const auto add = [&](unsigned need, const char* what) {
    if ((missing & need) != 0) text += (text.empty() ? "" : " and ") + std::string(what);
  };
  add(kServoNever, "the change that this case makes cannot be undone");
  add(kServoMotion, "needs --allow-motion");
  add(kServoEeprom, "needs --allow-eeprom");
  add(kServoAlone, "needs --alone, because the case reaches every servo at the port");
  add(kServoModel, "this model or its firmware does not support the case");
  return text;
}

Result<std::vector<const ServoCase*>> chosen(ServoFamily family, const std::string& filter) {
  std::vector<const ServoCase*> taken;
  try {
    const std::regex pattern(filter);
    for (const ServoCase& one : servo_cases(family)) {
      if (std::regex_search(one.of.id, pattern) ||
          std::regex_search(one.of.statements.front(), pattern))
        taken.push_back(&one);
    }
  } catch (const std::regex_error& wrong) {
    return fail(Fault::usage,
                "--filter " + filter + " is not a regular expression: " + wrong.what());
  }
  if (taken.empty())
    return fail(Fault::usage,
                "--filter " + filter +
                    " matches no case; `kaz conformance --bus PROTOCOL --list` lists the cases");
  return taken;
}

Result<RunReport> run_bus_suite(host::Link& link, host::Clock& clock,
                                const BusRunOptions& options) {
  const auto taken = KAZ_TRY(chosen(options.family, options.filter));
  ExaminedServo servo(link, clock, options.family, options.id);
  KAZ_TRY(servo.identify(options.release));
  RunReport report;
  report.board = servo.title();
  for (const ServoCase* one : taken) {
    try {
      const Time began = clock.now();
      report.results.push_back(run_one(*one, servo, options));
      report.results.back().seconds = seconds(clock.now() - began);
    } catch (const Lost& lost) {
      const bool interrupted = lost.error.fault == Fault::interrupted;
      const auto left = leave(servo, true, options.interrupt);
      if (!interrupted)
        return fail(lost.error.fault,
                    lost.error.message + (left || (options.allowed & kServoMotion) == 0
                                              ? ""
                                              : "; and " + left.error().message));
      KAZ_TRY(left);
      report.interrupted = true;
      for (std::size_t i = report.results.size(); i < taken.size(); ++i)
        report.not_run.push_back(&taken[i]->of);
      return report;
    }
    if (options.progress)
      options.progress(report.results.back(), report.results.size(), taken.size());
  }
  return report;
}

}  // namespace kaz::hil
