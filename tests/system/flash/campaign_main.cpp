// The whole campaign: usage: flash_campaign RUNS IMAGE WRITER [FIRST_SEED]
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <map>

#include "tests/system/flash/campaign.h"

namespace {

using kaz::flash_test::CampaignRun;
using kaz::flash_test::Stands;

// Of one kind of fault: runs that reported success, and what failures left in the flash.
struct Counts {
  int runs = 0, done = 0, before = 0, fresh = 0, none = 0, faults = 0;

  void add(const CampaignRun& run) {
    ++runs;
    faults += !run.fault.empty();
    if (run.reported_success) {
      ++done;
    } else {
      ++(run.stands == Stands::before ? before : run.stands == Stands::fresh ? fresh : none);
    }
  }
};

void print(const char* kind, const Counts& c) {
  std::printf("%-16s %5d %8d %10d %10d %10d %7d\n", kind, c.runs, c.done, c.before, c.fresh, c.none,
              c.faults);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: flash_campaign RUNS IMAGE WRITER [FIRST_SEED]\n");
    return 2;
  }
  const long runs = std::atol(argv[1]);
  const std::uint64_t first = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  std::map<std::string, Counts> kinds;
  Counts all;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(runs); ++seed) {
    const CampaignRun run = kaz::flash_test::campaign_run(seed, argv[2], argv[3]);
    kinds[run.kind].add(run);
    all.add(run);
    if (run.fault.empty()) continue;
    std::printf("%s\n  FAULT: %s\n", run.text.c_str(), run.fault.c_str());
    std::fflush(stdout);
  }
  std::printf("%-16s %5s %8s %32s %7s\n", "", "", "reported", "reported failure; stands", "");
  std::printf("%-16s %5s %8s %10s %10s %10s %7s\n", "what went wrong", "runs", "success",
              "old image", "new image", "none", "faults");
  for (const auto& [kind, counts] : kinds) print(kind.c_str(), counts);
  print("all", all);
  return all.faults == 0 ? 0 : 1;
}
