// Target of `kaz bench`: an emulated board on the virtual motor stand, or a board at a port with a stand.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hil/bench/motor/stand.h"
#include "host/link/interrupt.h"
#include "host/link/lateness.h"
#include "host/link/link.h"
#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"
#include "tools/run/backend.h"

namespace kaz::tools {

struct BenchTargetOptions {
  // Port of the board, as for parse_port_address(); empty: the virtual stand.
  std::string port;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // address of the board at the port
  // Stand of the board at the port: "", "manual" or "ctl:PATH".
  std::string stand;
  BackendOptions backend;  // for the virtual stand; uses mcu, image, motor, disc, sensors and seed
};

class BenchTarget {
 public:
  // Fails with Fault::usage for options that exclude each other and for invalid files, and with
  // Fault::environment if a port or stand is missing. `interrupt` must outlive the target.
  static Result<std::unique_ptr<BenchTarget>> open(const BenchTargetOptions& options,
                                                   host::Interrupt& interrupt);
  virtual ~BenchTarget() = default;
  virtual std::string name() const = 0;  // for example "virtual board (h8)" or "/dev/ttyUSB0"
  virtual host::Link& link() = 0;
  virtual host::Clock& clock() = 0;
  virtual hil::Stand* stand() = 0;  // null if there is no stand
  // Meter that measures how late this machine serves link() and clock(), for a board at a port. Null if the
  // time is simulated.
  virtual host::LatenessMeter* lateness() = 0;
};

}  // namespace kaz::tools
