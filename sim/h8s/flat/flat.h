// Flat machine: the CPU with 16 MiB of RAM and no peripherals, for programs that need no board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "shared/image/image.h"
#include "sim/h8s/cpu/types.h"

namespace kaz::h8s {

struct FlatOptions {
  Engine engine = Engine::translator;
  // JSR @@0xC7:8 is a semihosting request and a marked SLEEP ends the program (see Flat). If false, both are
  // ordinary instructions.
  bool semihost = true;
  // Number of jumps to an address before its code is translated; affects speed only.
  std::uint32_t translate_after = 1000;
  bool predecrement_stores_decremented = true;  // see Options
};

// Reason and place at which Flat::run returned.
struct FlatStop {
  enum class Reason {
    reached,                // a limit was reached
    exited,                 // SLEEP with the end mark; `status` is the program's exit status
    asleep,                 // any other SLEEP, which would never end
    undefined_instruction,  // includes instructions of the H8S/2600 only
    odd_pc,
    bad_request,    // unknown semihosting request or descriptor
    output_failed,  // the output listener returned false
  };
  Reason reason = Reason::reached;
  int status = 0;            // exited: 0..255
  std::uint32_t pc = 0;      // address of the instruction; for `reached` that of the next one
  std::uint16_t opcode = 0;  // first word at `pc`
  std::string text;          // one line with reason, PC and opcode; empty for `exited`
};

// Advanced mode without I/O registers, interrupts and stack check. 0x000000 to 0xFFFFFF is RAM, initially
// zero. States are those with on-chip memory. Addresses wrap at 24 bits. A word access at an odd address uses
// the even address below. TRAPA uses the vectors in RAM. One thread at a time; different machines are
// independent.
//
// Semihosting follows GDB's simulator for the H8:
// - JSR @@0xC7:8 (5F C7) writes the ER2 bytes at ER1 to descriptor ER0 and sets ER0 to their number.
//   Descriptors 0 and 1 are standard output, 2 is standard error. JSR @@0xC5:8, @@0xC6:8 and @@0xC8:8 to
//   @@0xCC:8 are errors.
// - SLEEP with 0xDEAD in R1, 0xBEEF in R2 and 0 in R0L ends the program with status R0H.
//
// Both count as one instruction and take the states of the table (6 and 2).
class Flat {
 public:
  explicit Flat(const FlatOptions& options = {});
  ~Flat();
  Flat(Flat&&) noexcept;
  Flat& operator=(Flat&&) noexcept;

  // Writes the sections of the image to their run addresses and sets PC to its entry point. Other memory and
  // registers are unchanged. Errors, without any change: a section beyond 0xFFFFFF, no entry point, an image
  // for normal mode.
  Result<void> load(const Image& image);
  const SymbolTable& symbols() const;

  // Listener for the program's output. `stream` is 1 (standard output) or 2 (standard error). The run stops
  // if it returns false.
  using Output = std::function<bool(int stream, std::span<const std::uint8_t> bytes)>;
  void on_output(Output listener);

  static constexpr States kNoLimit = std::numeric_limits<States>::max();
  // Runs until now() >= until, instructions() >= count, or the program ends. After the end each further call
  // returns the same stop, until set_registers() or load().
  FlatStop run(States until = kNoLimit, std::int64_t count = kNoLimit);
  States now() const;
  std::int64_t instructions() const;  // executed so far; EEPMOV counts as one

  Registers registers() const;
  // Also allows a program that has ended to continue.
  void set_registers(const Registers& registers);
  // Reads and writes of RAM. Addresses are taken modulo 2^24.
  std::uint8_t peek(std::uint32_t address) const;
  std::uint16_t peek16(std::uint32_t address) const;
  std::uint32_t peek32(std::uint32_t address) const;
  void poke(std::uint32_t address, std::uint8_t value);
  void poke(std::uint32_t address, std::span<const std::uint8_t> from);
  // As Chip::disassemble.
  std::string disassemble(std::uint32_t address, int* length = nullptr) const;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace kaz::h8s
