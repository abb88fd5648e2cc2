// What `kaz bench` measures: an emulated board on the virtual motor stand, or one on a port with
// whatever stand there is.
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
#include "tools/app/session/backend.h"

namespace kaz::tools {

struct BenchTargetOptions {
  std::string port;                           // as parse_port_address() has it; empty: the virtual stand
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // at a port
  std::string stand;                          // at a port: "", "manual" or "ctl:PATH"
  BackendOptions backend;  // of the virtual stand: mcu, image, motor, disc, sensors, seed
};

class BenchTarget {
 public:
  // Errors: options that exclude each other, files (usage); a port or stand that is not there
  // (environment). `interrupt` must outlive it.
  static Result<std::unique_ptr<BenchTarget>> open(const BenchTargetOptions& options,
                                                   host::Interrupt& interrupt);
  virtual ~BenchTarget() = default;
  virtual std::string name() const = 0;  // "virtual board (h8)", "/dev/ttyUSB0"
  virtual host::Link& link() = 0;
  virtual host::Clock& clock() = 0;
  virtual hil::Stand* stand() = 0;  // null: none
  // Of link() and clock(), at a port; null in simulated time.
  virtual host::LatenessMeter* lateness() = 0;
};

}  // namespace kaz::tools
