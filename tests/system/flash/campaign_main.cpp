// flash_campaign: many runs of flashing with a random fault in each, and their table.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <map>

#include <CLI/CLI.hpp>

#include "tests/studies/common/program.h"
#include "tests/studies/common/table.h"
#include "tests/system/flash/campaign.h"

namespace {

using kaz::flash_test::CampaignRun;
using kaz::flash_test::Stands;

// Of one kind of fault: runs that reported success, and the image in flash after reported failures.
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

std::vector<std::string> row(const std::string& kind, const Counts& c) {
  std::vector<std::string> cells{kind};
  for (const int count : {c.runs, c.done, c.before, c.fresh, c.none, c.faults})
    cells.push_back(std::to_string(count));
  return cells;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace kaz;
  CLI::App app("Flashing in simulated time with a random fault in each run, by seed.");
  int runs = 500;
  std::uint64_t first = 1;
  std::string image, writer, markdown;
  app.add_option("runs", runs, "number of seeds")->required()->check(CLI::Range(1, 1000000));
  app.add_option("image", image, "the firmware, kaz.mot")->required();
  app.add_option("writer", writer, "the flash writer, writer.bin")->required();
  app.add_option("first-seed,--first-seed", first, "the seeds begin with it")
      ->capture_default_str();
  studies::add_markdown_option(app, markdown);
  return studies::run_program(app, "flash_campaign", argc, argv, [&]() -> Result<void> {
    std::map<std::string, Counts> kinds;
    Counts all;
    for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(runs); ++seed) {
      const CampaignRun run = flash_test::campaign_run(seed, image, writer);
      kinds[run.kind].add(run);
      all.add(run);
      if (run.fault.empty()) continue;
      std::printf("%s\n  FAULT: %s\n", run.text.c_str(), run.fault.c_str());
      std::fflush(stdout);
    }
    studies::MarkdownTable table({"fault", "runs", "success reported", "failure: old image",
                                  "failure: new image", "failure: no image", "violations"});
    for (const auto& [kind, counts] : kinds) table.add(row(kind, counts));
    table.add(row("all", all));
    std::printf("%s", table.text().c_str());
    if (all.faults > 0)
      return fail(Fault::failed, std::to_string(all.faults) + " violations, see above");
    return studies::write_markdown(markdown, studies::command_line(argc, argv),
                                   std::to_string(runs) + " seeds", table.text());
  });
}
