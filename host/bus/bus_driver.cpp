// Drivers by protocol.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/bus_driver.h"

#include "host/bus/dynamixel_driver.h"
#include "host/bus/feetech_driver.h"

namespace kaz::host {

std::unique_ptr<BusDriver> BusDriver::make(servo_bus::Protocol protocol, Link& link, Clock& clock) {
  if (protocol == servo_bus::Protocol::dynamixel)
    return std::make_unique<DynamixelDriver>(link, clock);
  return std::make_unique<FeetechDriver>(link, clock);
}

}  // namespace kaz::host
