// Runs single instructions on the chip and on the oracle, with chosen or random operands.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/cpu/oracle_model_testing.h"

namespace kaz::h8s::oracle {

// Returns the encoding of `form` with the field values `fields`.
std::vector<u16> encode(const Form& form, const Fields& fields);

// Fixed bits of an encoding: `value` where `mask` is set.
struct Pin {
  std::array<u16, 5> mask{}, value{};
  std::vector<u16> apply(std::vector<u16> units) const;
};

// A chip and its model. Chip and model have the same memory contents: random bytes.
class Bench {
 public:
  explicit Bench(bool normal, const Options& options = {});

  // Writes `units` to address `at` and runs this instruction on chip and model, beginning with the state
  // `before`. Returns the differences; empty if chip and model agree.
  std::string trial(const Form& form, const std::vector<u16>& units, const World& before, u32 at);
  // Runs a trial with random fields, registers and flags, often at the limits of their ranges. If `io` is
  // false, data addresses are in memory. If `io` is true, data addresses belong to I/O registers that return
  // the value written.
  std::string random_trial(const Form& form, bool io);
  // The two parts of a random trial. draw_units returns an encoding of `form` whose operands may be accessed;
  // `pin` fixes some bits of the encoding. draw_registers returns registers and flags for that encoding.
  std::vector<u16> draw_units(const Form& form, bool io, const Pin& pin = {});
  World draw_registers(const Form& form, const std::vector<u16>& units, bool io);
  // Copies the I/O registers that trials with `io` use from the chip to the model.
  void read_io();
  // Writes flash or RAM of chip and model. `address` must be in flash or RAM.
  void put(u32 address, std::span<const u8> bytes);
  void put(u32 address, const std::vector<u16>& units);
  // Returns the number of states by which an access takes longer than an access to on-chip memory.
  int io_states(const Access& a) const;
  // Compares registers, and memory at `accesses`. Returns the differences; empty if there are no differences.
  // Register values that the manual leaves undefined are copied from the chip to the model.
  std::string compare(std::span<const Access> accesses, u8 open_flags, bool open_result);
  // Returns the model's accesses outside memory since the last call, as text.
  std::string outside() { return std::exchange(outside_, {}); }
  // Targets of three quarters of the random jumps, calls and returns. All other jumps, calls and returns go
  // to any address. If `landings` is empty, every target is any address.
  std::vector<u32> landings;
  // Compares the whole RAM of chip and model. Returns the first difference; empty if there is no difference.
  std::string compare_memory();

  World world;  // the model; the model's memory belongs to this object
  Chip chip;
  std::mt19937 random{12345};

  static constexpr u32 kFlashCode = 0x3000, kRamCode = 0xffe200;

 private:
  u8 model_read(u32 address);
  void model_write(u32 address, u8 value);
  u32 border(u32 bits);
  u32 data_address(const Form& form, bool io, bool in_ram);
  u32 landing();
  void aim_fields(const Form& form, Fields& f, bool io);
  void aim_registers(const Form& form, const Fields& f, World& before, bool io);

  u32 code_at_ = 0;
  std::vector<u16> code_;
  std::vector<u8> flash_, ram_;  // ram_ begins at address 0xffe000
  std::map<u32, u8> io_;
  std::string outside_;  // accesses of the model to addresses without memory
};

}  // namespace kaz::h8s::oracle
