// A request to servo 1 as it stands on the wire, and a register by its name.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "shared/feetech/packet.h"
#include "shared/servo_bus/registers.h"

namespace feetech = kaz::feetech;

int main() {
  const auto ping = feetech::request(1, feetech::Instruction::ping);
  for (const auto byte : feetech::wire_of(ping)) std::printf("%02x ", byte);
  const auto* model = kaz::servo_bus::find_model("sts3215");
  std::printf("\n");
  return model != nullptr ? 0 : 1;
}
