// Test helper: path of the firmware image under test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>

namespace kaz::sim {

// Returns the path of the image of this build. If the environment variable KAZ_TEST_IMAGE is set, returns its
// value instead. The value is the path of a mutant (tests/integration/conformance/mutate.py), or of a variant
// for measurements.
inline std::string firmware_image() {
  const char* other = std::getenv("KAZ_TEST_IMAGE");
  return other ? other : KAZ_FIRMWARE_IMAGE;
}

}  // namespace kaz::sim
