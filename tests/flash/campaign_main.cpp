// The whole campaign: usage: flash_campaign RUNS IMAGE WRITER [FIRST_SEED]
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <map>

#include "tests/flash/campaign.h"

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: flash_campaign RUNS IMAGE WRITER [FIRST_SEED]\n");
    return 2;
  }
  const long runs = std::atol(argv[1]);
  const std::uint64_t first = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  std::map<std::string, std::pair<int, int>> kinds;  // runs, successes reported
  int faults = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(runs); ++seed) {
    const auto run = kaz::flash_test::campaign_run(seed, argv[2], argv[3]);
    ++kinds[run.kind].first;
    kinds[run.kind].second += run.reported_success;
    if (run.fault.empty()) continue;
    ++faults;
    std::printf("%s\n  FAULT: %s\n", run.text.c_str(), run.fault.c_str());
    std::fflush(stdout);
  }
  for (const auto& [kind, counts] : kinds)
    std::printf("%-16s %4d runs, %4d succeeded all the same\n", kind.c_str(), counts.first,
                counts.second);
  std::printf("%ld runs, %d faults\n", runs, faults);
  return faults == 0 ? 0 : 1;
}
