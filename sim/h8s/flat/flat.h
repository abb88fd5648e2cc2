// A bare machine: the same CPU in 16 MiB of RAM, for programs that need no board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "shared/image/error.h"
#include "shared/image/image.h"
#include "sim/h8s/cpu/types.h"

namespace kaz::h8s {

struct FlatOptions {
  Engine engine = Engine::translator;
  // Programs ask the host by JSR @@0xC7:8 and end by a marked SLEEP (see Flat); else both are the
  // plain instructions.
  bool semihost = true;
  // How often a place is jumped to before it is translated; affects speed only.
  std::uint32_t translate_after = 1000;
  bool predecrement_stores_decremented = true;  // as in Options
};

// Why Flat::run came back.
struct FlatStop {
  enum class Reason {
    reached,                // a limit
    exited,                 // SLEEP with the mark of an end; `status` is the program's
    asleep,                 // any other SLEEP: nothing here could wake it
    undefined_instruction,  // H8S/2600 ones too
    odd_pc,
    bad_request,    // a host request that does not exist
    output_failed,  // the listener could not take what the program wrote
  };
  Reason reason = Reason::reached;
  int status = 0;            // exited: 0..255
  std::uint32_t pc = 0;      // of the instruction concerned; reached: of the next one
  std::uint16_t opcode = 0;  // the first word there
  std::string text;          // one line with PC and opcode; empty for `exited`
};

// Advanced mode, 0x000000 to 0xFFFFFF plain RAM, zero at first; no registers of a chip, no
// interrupts, no stack check. All on-chip timing: states as in the chip's own memory. Addresses
// wrap at 24 bits, words at odd addresses are taken at the even ones below, TRAPA goes through the
// vectors in RAM.
//
// Semihosting is GDB's for the H8: JSR @@0xC7:8 (5F C7) writes ER2 bytes at ER1 to descriptor ER0 (0
// and 1 standard output, 2 standard error), leaves their number in ER0 and goes on behind; @@0xC5,
// 0xC6 and 0xC8 to 0xCC do not exist. SLEEP with 0xDEAD in R1, 0xBEEF in R2 and 0 in R0L ends the
// program with status R0H. Both count as one instruction with their states in the table (6 and 2).
class Flat {
 public:
  explicit Flat(const FlatOptions& options = {});
  ~Flat();
  Flat(Flat&&) noexcept;
  Flat& operator=(Flat&&) noexcept;

  // Sections with contents go to their run addresses, PC to the entry; memory elsewhere and the
  // registers are as at the start. Errors: a section beyond 0xFFFFFF, no entry, an image for
  // normal mode.
  Result<void> load(const Image& image);
  const SymbolTable& symbols() const;

  // What the program writes: `stream` is 1 or 2. False: could not be taken, the run stops.
  using Output = std::function<bool(int stream, std::span<const std::uint8_t> bytes)>;
  void on_output(Output listener);

  static constexpr States kNoLimit = std::numeric_limits<States>::max();
  // Runs until now() >= until or instructions() >= count, or it ends. An end repeats at each
  // further call.
  FlatStop run(States until = kNoLimit, std::int64_t count = kNoLimit);
  States now() const;
  std::int64_t instructions() const;  // EEPMOV is one

  Registers registers() const;
  // Takes back an end.
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
