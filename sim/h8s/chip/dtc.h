// Data transfer controller (DTC): an interrupt request starts a transfer. During the transfer, the CPU waits
// for the bus.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Dtc {
 public:
  // Register accesses: DTCERA..DTVECR.
  std::uint8_t peek(std::uint32_t address) const;
  std::uint8_t read(std::uint32_t address);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);

  // If an activation is due at this instruction boundary, executes the activation, advances Cpu::now and
  // returns true. Otherwise returns false.
  bool run(Machine& m);
  // Returns the time at which the next activation may begin; kNever without a request.
  States earliest(const Machine& m) const;
  bool idle() const { return !(dtvecr_ & DTVECR::SWDTE) || ended_; }

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(dtcer_, dtvecr_, swdte_seen_, ended_, software_at_, rdr_read_, tdr_written_, result_read_);
  }

 private:
  struct Block;  // the DTC's register information in RAM
  struct Outcome {
    bool ended;  // the CPU receives the interrupt
    bool valid;  // the register information was valid
  };

  Outcome serve(Machine& m, unsigned vector);
  bool transfer(Machine& m, Block& b);  // returns true if this was the last programmed transfer
  void move(Machine& m, Block& b);
  void release(Machine& m, unsigned vector);
  void divert(Machine& m);

  std::array<std::uint8_t, 5> dtcer_{};
  std::uint8_t dtvecr_ = 0;
  bool swdte_seen_ = false;  // true: the program has read SWDTE as 1
  bool ended_ = false;       // a software activation is complete and requests its interrupt
  States software_at_ = 0;
  // Data registers that the current activation has accessed. If the activation has not accessed a data
  // register of the requesting serial channel or converter, the DTC does not clear the request flag.
  std::array<bool, 2> rdr_read_{}, tdr_written_{};
  bool result_read_ = false;
};

}  // namespace kaz::h8s
