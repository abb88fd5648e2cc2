// A virtual servo answers a ping.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "shared/feetech/packet.h"
#include "sim/bus/feetech_servo.h"

namespace feetech = kaz::feetech;

int main() {
  const auto* model = kaz::servo_bus::find_model("sts3215");
  if (model == nullptr) return 1;
  kaz::sim::FeetechServo servo(*model, 1);
  servo.set_power(true, {});
  kaz::Time now = std::chrono::seconds(2);  // it has started by then
  std::size_t answer = 0;
  for (const auto byte : feetech::wire_of(feetech::request(1, feetech::Instruction::ping)))
    if (const auto given = servo.take(byte, now)) answer = given->bytes.size();
  std::printf("%zu bytes\n", answer);
  return answer == 6 ? 0 : 1;
}
