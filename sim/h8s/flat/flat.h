// Flat: the CPU with 16 MiB of RAM and nothing else, for programs that need no board.
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
  // JSR @@0xC7:8 is a semihosting request and a marked SLEEP ends the program (see Flat); else both are
  // plain instructions.
  bool semihost = true;
  // Number of jumps to an address before its code is translated; affects speed only.
  std::uint32_t translate_after = 1000;
  bool predecrement_stores_decremented = true;  // as in Options
};

// Why Flat::run returned.
struct FlatStop {
  enum class Reason {
    reached,                // a limit
    exited,                 // SLEEP with the end mark; `status` is the program's
    asleep,                 // any other SLEEP: nothing can wake it
    undefined_instruction,  // H8S/2600 ones too
    odd_pc,
    bad_request,    // an unknown semihosting request
    output_failed,  // the output listener returned false
  };
  Reason reason = Reason::reached;
  int status = 0;            // exited: 0..255
  std::uint32_t pc = 0;      // of the instruction concerned; reached: of the next one
  std::uint16_t opcode = 0;  // the first word there
  std::string text;          // one line with PC and opcode; empty for `exited`
};

// Advanced mode; 0x000000 to 0xFFFFFF is RAM, initially zero; no I/O registers, no interrupts, no stack
// check. States as with on-chip memory. Addresses wrap at 24 bits, word accesses at odd addresses use
// the even address below, TRAPA uses the vectors in RAM.
//
// Semihosting is GDB's for the H8: JSR @@0xC7:8 (5F C7) writes ER2 bytes at ER1 to descriptor ER0 (0
// and 1 standard output, 2 standard error), sets ER0 to their number and continues; @@0xC5,
// 0xC6 and 0xC8 to 0xCC are errors. SLEEP with 0xDEAD in R1, 0xBEEF in R2 and 0 in R0L ends the
// program with status R0H. Both count as one instruction with their states in the table (6 and 2).
class Flat {
 public:
  explicit Flat(const FlatOptions& options = {});
  ~Flat();
  Flat(Flat&&) noexcept;
  Flat& operator=(Flat&&) noexcept;

  // Writes sections with contents to their run addresses and sets PC to the entry; other memory and
  // registers are unchanged. Errors: a section beyond 0xFFFFFF, no entry, an image for
  // normal mode.
  Result<void> load(const Image& image);
  const SymbolTable& symbols() const;

  // Called with the program's output; `stream` is 1 or 2. Returning false stops the run.
  using Output = std::function<bool(int stream, std::span<const std::uint8_t> bytes)>;
  void on_output(Output listener);

  static constexpr States kNoLimit = std::numeric_limits<States>::max();
  // Runs until now() >= until, instructions() >= count, or the program ends. After an end each further
  // call returns the same stop.
  FlatStop run(States until = kNoLimit, std::int64_t count = kNoLimit);
  States now() const;
  std::int64_t instructions() const;  // EEPMOV is one

  Registers registers() const;
  // Also clears an end.
  void set_registers(const Registers& registers);
  // Addresses are taken modulo 2^24.
  std::uint8_t peek(std::uint32_t address) const;
  std::uint16_t peek16(std::uint32_t address) const;
  std::uint32_t peek32(std::uint32_t address) const;
  void poke(std::uint32_t address, std::uint8_t value);
  void poke(std::uint32_t address, std::span<const std::uint8_t> from);
  std::string disassemble(std::uint32_t address, int* length = nullptr) const;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace kaz::h8s
