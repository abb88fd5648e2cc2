// The page of a fit says where it comes from.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/fit_report.h"

#include <gtest/gtest.h>

namespace kaz::tools {
namespace {

TEST(FitReport, PageHasItsProvenance) {
  lockstep::MotorFit fit;
  fit.motor.name = "m <1>";
  fit.rounds = 6;
  const hil::Provenance from = {"2026-01-02T03:04:05Z", "0.1.0", "a <cpu>", "an OS", 2,
                                "kaz bench fit motor"};
  const std::string page = fit_html(fit, "motor/result.json", from);
  for (const char* part :
       {"m &lt;1&gt;", "fitted to motor/result.json", "by kaz 0.1.0, in 6 rounds",
        "2026-01-02T03:04:05Z, a &lt;cpu&gt;, 2 cores, an OS", "<code>kaz bench fit motor</code>"})
    EXPECT_NE(page.find(part), std::string::npos) << part << "\n" << page;
}

}  // namespace
}  // namespace kaz::tools
