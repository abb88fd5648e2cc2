// GDB's remote protocol for a chip: bytes in, bytes out, no sockets and no clock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/debug/gdb_packet.h"
#include "sim/h8s/debug/history.h"

namespace kaz::h8s {

// Registers in the order of GDB's h8300s target, 4 bytes each, big-endian (the `g` packet):
//   0-7 er0..er6, sp   8 ccr   9 pc   10 cycles: states since power-on, low 32 bits   11 exr
//   12 tick: states, high 32 bits   13 inst: instructions executed   14, 15 mach, macl: 0
// (this CPU has none, but GDB stops printing registers at a missing one)
// Writable: 0-9 and 11. Versions of GDB that do not read the architecture from target.xml need `set
// architecture h8300s`.
//
// Memory reads have no side effects, not even on I/O registers. Writes go to RAM and to flash, the latter
// without the programming sequence, as by a programmer. The number of breakpoints and watchpoints is not
// limited. Reverse execution uses History, which records the chip from the server's construction on.
class GdbServer {
 public:
  explicit GdbServer(Chip& chip, HistoryOptions history = {});

  // Bytes from GDB, in pieces of any size.
  void feed(std::span<const std::uint8_t> bytes);
  // Bytes for GDB since the last call.
  std::string take_output();

  // True after GDB has resumed the chip: call run(states) until this is false, and feed bytes that arrive
  // meanwhile.
  bool running() const { return running_; }
  void run(States states);
  // Killed or detached.
  bool finished() const { return finished_; }

  // Reply to `monitor TEXT`.
  std::string monitor(std::string_view text);

 private:
  using Text = std::string_view;

  void handle(Text packet);
  std::string answer(Text packet);  // empty: unknown packet, as the protocol requires
  std::string query(Text packet);
  std::string transfer(Text packet);
  std::string resume(Text packet);
  std::string resume_threads(Text packet);
  std::string go_back(bool one_step);
  std::string registers() const;
  std::string set_registers(Text digits);
  std::string one_register(Text packet) const;
  std::string set_one_register(Text packet);
  std::string read_memory(Text packet) const;
  std::string write_memory(Text packet, bool binary);
  std::string flash(Text packet);
  std::string change_trigger(Text packet);
  std::string console(const std::string& text);
  std::string memory_map() const;

  Triggers triggers() const;
  std::string stopped(const Halt& halt);
  std::string single_step();
  bool set_pc(Text address);
  void send(std::string_view data);

  struct Trigger {
    int type;  // 0..4 as in the Z packets
    std::uint32_t address, size;
    bool operator==(const Trigger&) const = default;
  };

  Chip& chip_;
  History history_;
  GdbFraming framing_;
  std::vector<GdbInput> inputs_;
  std::string output_, last_sent_;
  std::vector<Trigger> set_;
  std::string last_stop_ = "S05";
  bool acknowledge_ = true;
  bool running_ = false;
  bool just_resumed_ = false;
  bool finished_ = false;
};

}  // namespace kaz::h8s
