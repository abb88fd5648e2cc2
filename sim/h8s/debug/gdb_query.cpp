// GDB's remote protocol: queries, target descriptions, and `monitor` commands.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "sim/h8s/debug/gdb_server.h"

namespace kaz::h8s {
namespace {

constexpr std::string_view kTarget =
    "<?xml version=\"1.0\"?>\n<!DOCTYPE target SYSTEM \"gdb-target.dtd\">\n"
    "<target version=\"1.0\"><architecture>h8300s</architecture></target>\n";

constexpr std::string_view kHelp =
    "help            this text\n"
    "reset           pulse the RES pin; RAM keeps its contents\n"
    "registers       CPU registers with the symbol at PC\n"
    "report          registers, backtrace, last instructions\n"
    "states          states and instructions since power-on\n"
    "history         states that reverse execution can reach\n"
    "back STATE      go to the first instruction that begins at or after this state\n"
    "misuse          operations of the program that the manual forbids or leaves undefined\n"
    "symbol NAME     address of a symbol\n"
    "where ADDRESS   symbol and line at an address (hexadecimal)\n";

std::string describe_registers(const Chip& chip) {
  const Registers r = chip.registers();
  std::string text;
  for (unsigned n = 0; n < 8; ++n)
    text.append("er")
        .append(1, static_cast<char>('0' + n))
        .append(" ")
        .append(hex32(r.er[n]))
        .append(n % 4 == 3 ? "\n" : "  ");
  static constexpr char kNames[] = "IuHUNZVC";
  text += "ccr ";
  for (int bit = 7; bit >= 0; --bit) text += r.ccr >> bit & 1 ? kNames[7 - bit] : '-';
  text += "  exr " + hex32(r.exr).substr(6) + "  pc " + hex32(r.pc).substr(2) + " " +
          chip.symbols().describe(r.pc) + "\n";
  return text;
}

}  // namespace

std::string GdbServer::query(Text packet) {
  GdbReader in(packet);
  if (in.take("qSupported"))
    return "PacketSize=3ff0;swbreak+;hwbreak+;vContSupported+;QStartNoAckMode+;ReverseStep+;"
           "ReverseContinue+;qXfer:features:read+;qXfer:memory-map:read+";
  if (packet == "QStartNoAckMode") return "OK";
  if (packet == "qC") return "QC1";
  if (packet == "qfThreadInfo") return "m1";
  if (packet == "qsThreadInfo") return "l";
  if (packet.starts_with("qThreadExtraInfo")) return to_hex(Text("H8S/2128"));
  if (packet.starts_with("qAttached")) return "1";
  if (packet.starts_with("qSymbol")) return "OK";
  if (packet == "qOffsets") return "Text=0;Data=0;Bss=0";
  if (in.take("qXfer:")) return transfer(in.rest());
  if (in.take("qRcmd,")) {
    const auto bytes = from_hex(in.rest());
    if (!bytes) return "E01";
    return console(monitor(Text(reinterpret_cast<const char*>(bytes->data()), bytes->size())));
  }
  return "";
}

// Text for GDB's console, in as many packets as needed; returns the reply that ends it.
std::string GdbServer::console(const std::string& text) {
  constexpr std::size_t kPiece = kMaxPacket / 2 - 8;
  for (std::size_t at = 0; at < text.size(); at += kPiece)
    send(console_packet(Text(text).substr(at, kPiece)));
  return "OK";
}

// object:read:annex:offset,length
std::string GdbServer::transfer(Text packet) {
  GdbReader in(packet);
  std::string text;
  if (in.take("features:read:target.xml:"))
    text = kTarget;
  else if (in.take("memory-map:read::"))
    text = memory_map();
  else
    return in.take("features:read:") ? "E00" : "";
  const auto offset = in.number();
  if (!offset || !in.take(",")) return "E01";
  const auto length = in.number();
  if (!length || !in.empty()) return "E01";
  if (*offset >= text.size()) return "l";
  const std::size_t size = static_cast<std::size_t>(std::min<std::uint64_t>(*length, 0x1000));
  const std::string part = text.substr(static_cast<std::size_t>(*offset), size);
  return (*offset + part.size() < text.size() ? "m" : "l") + part;
}

std::string GdbServer::monitor(Text text) {
  std::istringstream in{std::string(text)};
  std::string command, argument;
  in >> command >> argument;
  if (command.empty() || command == "help") return std::string(kHelp);
  if (command == "reset") {
    chip_.reset();
    return "reset; pc is " + chip_.symbols().describe(chip_.registers().pc) + "\n";
  }
  if (command == "registers") return describe_registers(chip_);
  if (command == "report") return chip_.report() + "\n";
  if (command == "states")
    return std::to_string(chip_.now()) + " states, " + std::to_string(chip_.instructions()) +
           " instructions\n";
  if (command == "history")
    return "from state " + std::to_string(history_.begin()) + " to " +
           std::to_string(history_.end()) + ", now at " + std::to_string(chip_.now()) + "\n";
  if (command == "back") {
    std::istringstream number(argument);
    States at = 0;
    if (!(number >> at)) return "`back` needs a state (decimal); see `monitor history`\n";
    const auto moved = history_.back_to(at);
    return moved ? "at state " + std::to_string(chip_.now()) + "\n" : moved.error().message + "\n";
  }
  if (command == "misuse") {
    std::string all;
    for (const Misuse& m : chip_.misuse())
      all += m.text + " (" + hex32(m.address).substr(2) + ", from " +
             chip_.symbols().describe(m.pc) + ", " + std::to_string(m.count) + " times)\n";
    return all.empty() ? "none\n" : all;
  }
  if (command == "symbol") {
    const auto at = chip_.symbols().address_of(argument);
    return at ? hex32(*at).substr(2) + "\n" : "no symbol '" + argument + "'\n";
  }
  if (command == "where") {
    GdbReader digits(argument);
    digits.take("0x");
    const auto at = digits.number();
    if (!at || !digits.empty()) return "`where` needs an address (hexadecimal)\n";
    return chip_.symbols().describe(static_cast<std::uint32_t>(*at & 0xffffff)) + "\n";
  }
  return "unknown command '" + command + "'; `monitor help` lists all commands\n";
}

}  // namespace kaz::h8s
