// kaz_campaign: many rounds of the campaign and their table; exit code 1 if a round failed.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <CLI/CLI.hpp>

#include "tests/studies/common/program.h"
#include "tests/system/campaign/campaign.h"

int main(int argc, char** argv) {
  using namespace kaz;
  CLI::App app(
      "A moving robot loses host, line or power at random times: are the motors safe in time, and "
      "does the host reconnect by itself?");
  campaign::Options options;
  std::string markdown;
  options.image_path = KAZ_FIRMWARE_IMAGE;
  options.world_path = KAZ_WORLD;
  options.robot_path = KAZ_ROBOT "/kaz.urdf";
  options.camera_path = KAZ_ROBOT "/camera.json";
  app.add_option("rounds,--rounds", options.rounds, "rounds")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("seed,--seed", options.seed, "seed of the events")->capture_default_str();
  studies::add_markdown_option(app, markdown);
  app.footer("kaz_campaign 1000 7");
  options.progress = [](int done, int total) {
    if (done % 50 == 0) std::fprintf(stderr, "campaign: %d of %d rounds\n", done, total);
  };
  return studies::run_program(app, "kaz_campaign", argc, argv, [&]() -> Result<void> {
    const auto report = KAZ_TRY(campaign::run_campaign(options));
    std::printf("%s", report.text().c_str());
    if (!report.passed())
      return fail(Fault::failed, std::to_string(report.failures.size()) + " failures, see above");
    return studies::write_markdown(markdown, studies::command_line(argc, argv),
                                   std::to_string(options.rounds) + " rounds of 1 seed",
                                   report.table());
  });
}
