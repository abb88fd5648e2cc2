// One seeded run of flashing with something that goes wrong, and the judgement of what is left.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kaz::flash_test {

// The application that stands in the flash when flashing has ended, however it did.
enum class Stands { before, fresh, none };

struct CampaignRun {
  std::string text;   // "boot mode, running board, power cut at 1.234 s: refused; flashed again"
  std::string fault;  // what must not have been; empty: all is well
  std::string kind;   // of what went wrong
  bool reported_success = false;
  Stands stands = Stands::none;
};

// `image`: the firmware's kaz.mot; `writer`: writer.bin. The same seed does the same.
CampaignRun campaign_run(std::uint64_t seed, const std::string& image, const std::string& writer);

}  // namespace kaz::flash_test
