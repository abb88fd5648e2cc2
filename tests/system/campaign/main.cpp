// campaign [ROUNDS [SEED]]: as many rounds, a table, exit 1 if one went wrong.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/system/campaign/campaign.h"

int main(int argc, char** argv) {
  if (argc > 3 || (argc > 1 && std::atoi(argv[1]) < 1)) {
    std::fprintf(stderr, "usage: kaz_campaign [ROUNDS [SEED]]\n  kaz_campaign 1000 7\n");
    return 2;
  }
  kaz::campaign::Options options;
  options.image_path = KAZ_FIRMWARE_IMAGE;
  options.world_path = KAZ_WORLD;
  options.robot_path = KAZ_ROBOT "/kaz.urdf";
  options.camera_path = KAZ_ROBOT "/camera.json";
  if (argc > 1) options.rounds = std::atoi(argv[1]);
  if (argc > 2) options.seed = std::strtoull(argv[2], nullptr, 10);
  options.progress = [](int done, int total) {
    if (done % 50 == 0) std::fprintf(stderr, "campaign: %d of %d rounds\n", done, total);
  };
  const auto report = kaz::campaign::run_campaign(options);
  if (!report) {
    std::fprintf(stderr, "kaz_campaign: %s\n", report.error().message.c_str());
    return static_cast<int>(report.error().fault);
  }
  std::printf("%s", report->text().c_str());
  return report->passed() ? 0 : 1;
}
