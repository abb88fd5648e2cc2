// A firmware image, which may be a mutant, before the conformance suite or the comparison of the engines.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <string>

#include "hil/conformance/suite.h"
#include "sim/mcu/compare.h"
#include "tools/lockstep/virtual_bench.h"

namespace {

using namespace kaz;

int failure(const Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return static_cast<int>(error.fault);
}

int conformance(const std::string& image) {
  auto mcu = sim::make_h8(image);
  if (!mcu) return failure(mcu.error());
  lockstep::VirtualBench board(std::move(*mcu));
  hil::RunOptions options;
  options.allowed = hil::kMotion | hil::kFlash | hil::kBench | hil::kExact;
  options.progress = [](const hil::CaseResult& one, std::size_t, std::size_t) {
    if (one.verdict == hil::Verdict::failed) {
      std::printf("failed %s: %s\n", one.of->id.c_str(), one.message.c_str());
    }
  };
  const auto report = hil::run_suite(board, board, &board, Time::zero(), options);
  if (!report) return failure(report.error());
  std::printf("%zu cases\n", report->results.size());
  return report->count(hil::Verdict::failed) == 0 ? 0 : 1;
}

int comparison(const std::string& image, std::int64_t ticks) {
  sim::CompareOptions options;
  options.image_path = image;
  options.ticks = ticks;
  const auto report = sim::compare_engines(options);
  if (!report) return failure(report.error());
  std::printf("%s\n", report->text().c_str());
  return report->equal() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2) return conformance(argv[1]);
  if (argc == 4 && std::string(argv[2]) == "--compare")
    return comparison(argv[1], std::atoll(argv[3]));
  std::fprintf(stderr, "usage: image_suite IMAGE [--compare TICKS]\n");
  return 2;
}
