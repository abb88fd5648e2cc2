// A part of a bench that is measured again where the machine was late, and may be cut short.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/timed_part.h"

namespace kaz::hil {
namespace {

constexpr const char* kNotAgain = ", and the run ended before the measurement was repeated";

}  // namespace

Result<void> timed_part(BenchJudge& judge, const std::function<Result<void>(int run)>& part,
                        Time at_least, const BenchJudge::LineTrouble& line_trouble) {
  int run = 0;
  return judge.timed(
      [&]() -> Result<void> {
        const std::size_t first = judge.report().measurements.size();
        auto ran = part(++run);
        if (ran) return ran;
        const std::string late = judge.lateness() ? judge.lateness()->excuse(at_least) : "";
        if (!late.empty())
          judge.leave_undecided(first, late + kNotAgain, Measurement::Doubt::machine);
        const std::string trouble = line_trouble ? line_trouble() : "";
        if (!trouble.empty())
          judge.leave_undecided(first, trouble + kNotAgain, Measurement::Doubt::line);
        return ran;
      },
      at_least, line_trouble);
}

std::string run_text(const std::string& what, int run) {
  return run == 1 ? what
                  : "repeated because this machine was late or the line was disturbed: " + what;
}

}  // namespace kaz::hil
