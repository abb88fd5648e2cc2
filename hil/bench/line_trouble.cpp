// What befell the line while something else was measured.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/line_trouble.h"

#include "shared/base/counted.hpp"

namespace kaz::hil {

void add_trouble(std::string& trouble, const std::string& what) {
  trouble += (trouble.empty() ? "on the line " : ", ") + what;
}

std::string line_trouble(const host::LinkStatistics& before, const host::LinkStatistics& after) {
  std::string trouble;
  if (const auto lost = after.timeouts - before.timeouts; lost > 0)
    add_trouble(trouble,
                std::to_string(lost) + (lost == 1 ? " reply was lost" : " replies were lost"));
  if (const auto damaged = after.bad_frames - before.bad_frames; damaged > 0)
    add_trouble(trouble, counted(damaged, "frame") + " arrived damaged");
  return trouble;
}

}  // namespace kaz::hil
