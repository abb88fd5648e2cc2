// Runs single instructions on the chip and on the tests' own model, with chosen or random operands.
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
#include "sim/h8s/cpu/oracle.h"

namespace kaz::h8s::oracle {

// The units of a form with these field values.
std::vector<u16> encode(const Form& form, const Fields& fields);

// Bits of the units, valid where `mask` is set.
struct Pin {
  std::array<u16, 5> mask{}, value{};
  std::vector<u16> apply(std::vector<u16> units) const;
};

// A chip and a model of it with the same memory, filled at random.
class Bench {
 public:
  explicit Bench(bool normal, const Options& options = {});

  // Runs the instruction at `at` from this state on both. Empty if they agree, else the differences.
  std::string trial(const Form& form, const std::vector<u16>& units, const World& before, u32 at);
  // Fields, registers and flags at random, often at the borders; addresses point at memory or, if
  // `io`, at registers that keep what is written.
  std::string random_trial(const Form& form, bool io);
  // The two halves of a random trial: units of `form`, with operands that instructions may work on;
  // registers and flags with which these units reach them. `pin`: bits that are fixed.
  std::vector<u16> draw_units(const Form& form, bool io, const Pin& pin = {});
  World draw_registers(const Form& form, const std::vector<u16>& units, bool io);
  // The model knows the contents of registers at io_states' addresses from the chip.
  void read_io();
  // Writes flash or RAM of both.
  void put(u32 address, std::span<const u8> bytes);
  void put(u32 address, const std::vector<u16>& units);
  // States that an access takes besides those of memory.
  int io_states(const Access& a) const;
  // Compares registers and memory that the model has accessed; empty when equal. Values
  // that the manual leaves open are copied from the chip.
  std::string compare(std::span<const Access> accesses, u8 open_flags, bool open_result);
  // Accesses of the model outside memory since the last call.
  std::string outside() { return std::exchange(outside_, {}); }
  // Addresses that calls and jumps are drawn from, three times of four; none: any.
  std::vector<u32> landings;
  // Whole RAM of both; empty when equal.
  std::string compare_memory();

  World world;  // the model; its memory is this object's
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
  std::vector<u8> flash_, ram_;  // RAM: 0xffe000 up
  std::map<u32, u8> io_;
  std::string outside_;  // an address without memory that the model touched
};

}  // namespace kaz::h8s::oracle
