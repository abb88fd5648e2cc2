// Server of GDB's remote protocol for a chip. The server converts input bytes to output bytes. It uses
// neither sockets nor a clock.
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

// The `g` packet contains the registers of GDB's h8300s target, 4 bytes each, big-endian:
// - 0-7: er0..er6, sp.
// - 8 and 9: ccr and pc.
// - 10, cycles: states since power-on, low 32 bits.
// - 11: exr.
// - 12, tick: states since power-on, high 32 bits.
// - 13, inst: instructions executed.
// - 14 and 15, mach and macl: always 0. The CPU does not have these registers. The packet contains them
//   because GDB stops printing at the first missing register.
//
// Registers 0-9 and 11 are writable. Versions of GDB that do not read the architecture from target.xml need
// `set architecture h8300s`.
//
// Memory reads have no side effects, not even at I/O registers. Memory writes change RAM and flash. A write
// to flash needs no programming sequence. GDB can set at most 4,096 breakpoints and watchpoints. Reverse
// execution uses History, which starts to record the chip when the server is constructed. `chip` must outlive
// this object.
class GdbServer {
 public:
  explicit GdbServer(Chip& chip, HistoryOptions history = {});

  // Processes bytes from GDB, in pieces of any size.
  void feed(std::span<const std::uint8_t> bytes);
  // Removes and returns the bytes to send to GDB.
  std::string take_output();

  // Returns whether GDB has resumed the chip. While running() is true, call run(states), and pass new bytes
  // to feed().
  bool running() const { return running_; }
  void run(States states);
  // Returns whether GDB has killed the program or detached.
  bool finished() const { return finished_; }

  // Returns the reply to `monitor TEXT`.
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
    int type;  // type 0..4 of GDB's Z packets
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
