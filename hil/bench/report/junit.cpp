// A report as JUnit XML: a measurement is a test case of its subject.
// SPDX-License-Identifier: Apache-2.0
#include "hil/report/junit.h"
#include "hil/bench/report.h"
#include "hil/bench/report/numbers.h"

namespace kaz::hil {

std::string bench_junit(const BenchReport& report) {
  const int broken_off = report.interrupted.empty() ? 0 : 1;
  JunitSuite suite("kaz bench",
                   {report.count(Verdict::passed), report.count(Verdict::failed),
                    report.count(Verdict::left_out), report.count(Verdict::undecided), broken_off},
                   report.seconds);
  suite.property("board", report.board);
  suite.property("port", report.port);
  suite.property("program", report.program);
  if (report.seed) suite.property("seed", std::to_string(*report.seed));
  for (const auto& [name, value] : provenance_properties(report.from)) suite.property(name, value);
  for (const auto& [name, value] : report.conditions) suite.property(name, exact_text(value));
  for (const Measurement& one : report.measurements) {
    JunitCase test;
    test.group = one.subject;
    test.name = one.of->name;
    test.verdict = one.verdict;
    test.message = one.message;
    test.detail = one.of->text;
    if (one.verdict != Verdict::left_out) {
      test.output = value_with_unit(one) + ", limits: " + limits_text(one.low, one.high);
    }
    suite.add(test);
  }
  if (broken_off != 0) suite.add_error("bench", "the run is complete", report.interrupted);
  return suite.finish();
}

}  // namespace kaz::hil
