// Flat machine: the CPU with 16 MiB of RAM and no peripherals, for programs that need no board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "shared/image/image.h"
#include "sim/h8s/cpu/types.h"

namespace kaz::h8s {

struct FlatOptions {
  Engine engine = Engine::translator;
  // If true, JSR @@0xC7:8 is a semihosting request and a marked SLEEP ends the program (see Flat). If false,
  // JSR @@0xC7:8 and SLEEP are ordinary instructions.
  bool semihost = true;
  // Number of jumps to an address before the code at that address is translated. Affects speed only.
  std::uint32_t translate_after = 1000;
  bool predecrement_stores_decremented = true;  // see Options
};

// Reason why Flat::run returned, and the instruction at which the program stopped.
struct FlatStop {
  enum class Reason {
    reached,                // a limit of Flat::run was reached
    exited,                 // SLEEP with the end mark; `status` is the program's exit status
    asleep,                 // SLEEP without the end mark; this sleep would never end
    undefined_instruction,  // the H8S/2000 lacks the instruction; the H8S/2600 may have it
    odd_pc,
    bad_request,    // unknown semihosting request or descriptor
    output_failed,  // the output listener returned false
  };
  Reason reason = Reason::reached;
  int status = 0;  // exit status 0..255 for `exited`
  // Address of the last instruction. For `reached`: address of the next instruction.
  std::uint32_t pc = 0;
  std::uint16_t opcode = 0;  // first word at `pc`
  std::string text;          // one line with reason, PC and opcode; empty for `exited`
};

// The machine runs in advanced mode and has no I/O registers, no interrupts and no stack check. The addresses
// 0x000000 to 0xFFFFFF are RAM, which is initially zero. Each access takes as many states as an access to
// on-chip memory. Addresses wrap at 24 bits. A word access at an odd address A uses the even address A - 1.
// TRAPA uses the vectors in RAM. Only one thread at a time may use a machine. Different machines are
// independent.
//
// Semihosting follows GDB's simulator for the H8:
// - JSR @@0xC7:8 (5F C7) writes bytes to a descriptor. ER0 is the descriptor, ER1 the address of the bytes,
//   and ER2 the number of bytes. After the request, ER0 is the number of bytes written. Descriptors 0 and 1
//   are standard output, descriptor 2 is standard error. JSR @@0xC5:8, @@0xC6:8 and @@0xC8:8 to @@0xCC:8 are
//   errors.
// - SLEEP with 0xDEAD in R1, 0xBEEF in R2 and 0 in R0L ends the program with status R0H.
//
// The JSR and the SLEEP each count as one instruction. The JSR takes 6 states and the SLEEP takes 2 states,
// as in the manual's table.
class Flat {
 public:
  explicit Flat(const FlatOptions& options = {});
  ~Flat();
  Flat(Flat&&) noexcept;
  Flat& operator=(Flat&&) noexcept;

  // Writes the sections of the image to their run addresses and sets PC to the image's entry point. Other
  // memory and registers are unchanged. Errors: a section extends beyond 0xFFFFFF, the image has no entry
  // point, or the image is for normal mode. After an error the machine is unchanged.
  Result<void> load(const Image& image);
  const SymbolTable& symbols() const;

  // Listener for the program's output. `stream` is 1 (standard output) or 2 (standard error). If the listener
  // returns false, the run stops.
  using Output = std::function<bool(int stream, std::span<const std::uint8_t> bytes)>;
  void on_output(Output listener);

  static constexpr States kNoLimit = std::numeric_limits<States>::max();
  // Runs until the program ends or a limit is reached. The limit of now() is `until`; the limit of
  // instructions() is `count`. After the program has ended, each further call returns the last FlatStop until
  // set_registers() or load() is called.
  FlatStop run(States until = kNoLimit, std::int64_t count = kNoLimit);
  States now() const;
  std::int64_t instructions() const;  // number of executed instructions; EEPMOV counts as one

  Registers registers() const;
  // Sets the registers. If the program has ended, the next run() continues the program with these registers.
  void set_registers(const Registers& registers);
  // Read and write RAM. Addresses are taken modulo 2^24.
  std::uint8_t peek(std::uint32_t address) const;
  std::uint16_t peek16(std::uint32_t address) const;
  std::uint32_t peek32(std::uint32_t address) const;
  void poke(std::uint32_t address, std::uint8_t value);
  void poke(std::uint32_t address, std::span<const std::uint8_t> from);
  // Like Chip::disassemble.
  std::string disassemble(std::uint32_t address, int* length = nullptr) const;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace kaz::h8s
