// The data transfer controller: moves data on interrupt requests while the CPU waits for the bus.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

class Dtc {
 public:
  // DTCERA..DTCERE and DTVECR, FEEE..FEF3.
  std::uint8_t peek(std::uint32_t address) const;
  std::uint8_t read(std::uint32_t address);
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);

  // Does the transfers that are due at this instruction boundary; advances Cpu::now. False: none due.
  bool run(Machine& m);
  // When the next transfer may begin; kNever if nothing is requested.
  States earliest(const Machine& m) const;
  bool idle() const { return !(dtvecr_ & 0x80) || ended_; }

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(dtcer_, dtvecr_, swdte_seen_, ended_, software_at_, rdr_read_, tdr_written_, result_read_);
  }

 private:
  struct Block;  // register information as it lies in RAM
  struct Outcome {
    bool ended;  // an interrupt is requested of the CPU
    bool valid;
  };

  Outcome serve(Machine& m, unsigned vector);
  bool transfer(Machine& m, Block& b);  // true at the end of the count
  void move(Machine& m, Block& b);
  void release(Machine& m, unsigned vector);
  void divert(Machine& m);

  std::array<std::uint8_t, 5> dtcer_{};
  std::uint8_t dtvecr_ = 0;
  bool swdte_seen_ = false;  // read as 1
  bool ended_ = false;       // software activation is complete, its interrupt is requested
  States software_at_ = 0;
  // Registers accessed by the running activation; they decide whether the flag of a serial channel or
  // of the converter is cleared.
  std::array<bool, 2> rdr_read_{}, tdr_written_{};
  bool result_read_ = false;
};

}  // namespace kaz::h8s
