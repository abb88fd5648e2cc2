// The suite on the native engine that is linked here, which may be a mutant.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "hil/conformance/suite.h"
#include "tools/lockstep/virtual_bench.h"

int main() {
  using namespace kaz;
  lockstep::VirtualBench board(sim::make_native());
  hil::RunOptions options;
  options.allowed = hil::kMotion | hil::kFlash | hil::kBench | hil::kExact;
  options.progress = [](const hil::CaseResult& one, std::size_t, std::size_t) {
    if (one.verdict == hil::Verdict::failed) {
      std::printf("failed %s: %s\n", one.of->id.c_str(), one.message.c_str());
    }
  };
  const auto report = hil::run_suite(board, board, &board, Time::zero(), options);
  if (!report) {
    std::fprintf(stderr, "%s\n", report.error().message.c_str());
    return static_cast<int>(report.error().fault);
  }
  std::printf("%zu cases\n", report->results.size());
  return report->count(hil::Verdict::failed) == 0 ? 0 : 1;
}
