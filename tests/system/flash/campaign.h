// Runs one seeded flashing with a fault, and checks the board after it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kaz::flash_test {

// The application in flash at the end of a run: the old image, the new one, or neither.
enum class Stands { before, fresh, none };

struct CampaignRun {
  std::string text;  // "seed 8: boot mode, running board, power cut at 1.234 s: done", or its error
  std::string fault;  // violated requirement; empty if the run passed
  std::string kind;   // kind of the injected fault
  bool reported_success = false;
  Stands stands = Stands::none;
};

// `image`: path of the firmware's kaz.mot; `writer`: path of writer.bin. Deterministic for each seed.
CampaignRun campaign_run(std::uint64_t seed, const std::string& image, const std::string& writer);

}  // namespace kaz::flash_test
