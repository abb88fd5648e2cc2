// A part of a bench that is measured again where the machine was late, and may be cut short.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/timed_part.h"

namespace kaz::hil {
namespace {

// All that failed: a late part is measured again as a whole.
void leave_undecided(BenchJudge& judge, std::size_t first, Time at_least) {
  if (judge.lateness() == nullptr) return;
  const std::string excuse = judge.lateness()->excuse(at_least);
  if (excuse.empty()) return;
  auto& all = judge.report().measurements;
  for (std::size_t i = first; i < all.size(); ++i) {
    if (all[i].verdict != Verdict::failed) continue;
    all[i].verdict = Verdict::undecided;
    all[i].message += "; but " + excuse + ", and the run ended before it was measured again";
  }
}

}  // namespace

Result<void> timed_part(BenchJudge& judge, const std::function<Result<void>(int run)>& part,
                        Time at_least) {
  int run = 0;
  return judge.timed(
      [&]() -> Result<void> {
        const std::size_t first = judge.report().measurements.size();
        auto ran = part(++run);
        if (!ran) leave_undecided(judge, first, at_least);
        return ran;
      },
      at_least);
}

std::string run_text(const std::string& what, int run) {
  return run == 1 ? what : "late machine, again: " + what;
}

}  // namespace kaz::hil
