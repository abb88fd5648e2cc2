// The fuzzer must find a planted bug of the protocol, from nothing but its grammar and its rules.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "hil/fuzz/search.h"
#include "tools/fuzz/engine_case.h"

namespace kaz::fuzz {
namespace {

TEST(Planted, TheFuzzerFindsAStopThatIsIgnored) {
  constexpr int kCases = 20000;
  hil::fuzz::Search search(1);
  for (int i = 0; i < kCases; ++i) {
    const auto genome = search.next();
    const auto verdict = run_engine_case(genome, {});
    ASSERT_TRUE(verdict) << verdict.error().message;
    if (verdict->violation) {
      EXPECT_NE(verdict->violation->find("`stop`"), std::string::npos) << *verdict->violation;
      std::printf("case %d: %s\n", i, verdict->violation->c_str());
      return;
    }
    search.learn(genome, *verdict);
  }
  FAIL() << "not in " << kCases << " cases";
}

}  // namespace
}  // namespace kaz::fuzz
