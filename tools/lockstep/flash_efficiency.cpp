// `flash_efficiency`: an erased emulated board is flashed through boot mode, over an adapter that hands
// bytes over 1 ms late; the times as JSON for `kaz_benchmark`. Simulated time: the same on every machine.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "host/flash/flasher.h"
#include "tools/lockstep/flash_bench_testing.h"

namespace {

using namespace kaz;

Result<host::FlashReport> measure() {
  std::ifstream file(KAZ_WRITER, std::ios::binary);
  const std::vector<std::uint8_t> writer{std::istreambuf_iterator<char>(file), {}};
  const auto image = KAZ_TRY(host::FlashImage::load(KAZ_FIRMWARE_IMAGE));
  lockstep::FlashBench bench;
  bench.set_latency(std::chrono::milliseconds(1));
  host::Flasher flasher(bench, bench, writer, {});
  KAZ_TRY(flasher.enter_boot(bench));
  return flasher.write(image);
}

}  // namespace

int main() {
  const auto report = measure();
  if (!report) {
    std::fprintf(stderr, "flash_efficiency: %s\n", report.error().message.c_str());
    return static_cast<int>(report.error().fault);
  }
  const nlohmann::ordered_json result{{"efficiency", report->efficiency()},
                                      {"seconds", report->seconds},
                                      {"min_seconds", report->min_seconds},
                                      {"bytes", report->written},
                                      {"verified", report->verified}};
  std::printf("%s\n", result.dump(2).c_str());
  return report->verified ? 0 : 1;
}
