// For tests: the firmware image that they run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>

namespace kaz::sim {

// The build's image, or the one that KAZ_TEST_IMAGE names: a mutant
// (tests/integration/conformance/mutate.py), or the variant whose costs are to be measured.
inline std::string firmware_image() {
  const char* other = std::getenv("KAZ_TEST_IMAGE");
  return other ? other : KAZ_FIRMWARE_IMAGE;
}

}  // namespace kaz::sim
