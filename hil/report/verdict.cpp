// Verdicts in words.
// SPDX-License-Identifier: Apache-2.0
#include "hil/report/verdict.h"

namespace kaz::hil {

const char* verdict_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "passed";
    case Verdict::failed:
      return "failed";
    case Verdict::undecided:
      return "undecided";
    default:
      return "left out";
  }
}

}  // namespace kaz::hil
