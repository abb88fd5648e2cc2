// A request to servo 1 as it stands on the wires of both makers, and their models by name.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "shared/dynamixel/packet.h"
#include "shared/feetech/packet.h"
#include "shared/servo_bus/registers.h"

namespace feetech = kaz::feetech;

int main() {
  const auto ping = feetech::request(1, feetech::Instruction::ping);
  for (const auto byte : feetech::wire_of(ping)) std::printf("%02x ", byte);
  const auto other = kaz::dynamixel::request(1, kaz::dynamixel::Instruction::ping);
  std::printf("\n");
  for (const auto byte : kaz::dynamixel::wire_of(other)) std::printf("%02x ", byte);
  std::printf("\n");
  for (const char* name : {"sts3215", "xl330-m288"}) {
    if (kaz::servo_bus::find_model(name) == nullptr) return 1;
  }
  return 0;
}
