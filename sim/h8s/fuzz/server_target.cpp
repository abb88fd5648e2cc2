// Any bytes from GDB, and any text as a netlist.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <string_view>

#include "sim/h8s/debug/gdb_server.h"
#include "sim/h8s/fuzz/targets.h"
#include "sim/h8s/netlist/netlist.h"

namespace kaz::h8s::fuzz {
namespace {

// A chip that counts: inc.l #1,er0; bra back.
Chip counting() {
  Image image;
  image.segments.push_back({0, 0, "vectors", {0x00, 0x00, 0x10, 0x00}});
  image.segments.push_back({0x1000, 0x1000, "text", {0x0b, 0x70, 0x40, 0xfc}});
  Chip chip;
  (void)chip.load(image);
  chip.power_on();
  return chip;
}

}  // namespace

// Each line is a packet with its correct checksum; a line that begins with ! is passed unchanged.
std::string gdb(Bytes input) {
  Chip chip = counting();
  GdbServer server(chip);
  std::string_view rest(reinterpret_cast<const char*>(input.data()), input.size());
  std::size_t answered = 0;
  while (!rest.empty() && !server.finished()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(line.size() < rest.size() ? line.size() + 1 : rest.size());
    std::string packet(line);
    if (!packet.empty() && packet[0] == '!') {
      packet.erase(0, 1);
    } else {
      unsigned sum = 0;
      for (const char ch : packet) sum += static_cast<unsigned char>(ch);
      char tail[4];
      std::snprintf(tail, sizeof tail, "#%02x", sum & 0xff);
      packet = '$' + packet + tail;
    }
    server.feed({reinterpret_cast<const std::uint8_t*>(packet.data()), packet.size()});
    for (int k = 0; k < 4 && server.running(); ++k) server.run(500);
    answered += server.take_output().size();
    if (answered > 0x4000000) return "the server sent more than 64 MiB of replies";
  }
  return {};
}

std::string netlist(Bytes input) {
  Chip chip = counting();
  Netlist nets(chip);
  const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
  const Result<void> read = read_netlist(nets, text, "fuzz");
  if (!read && read.error().message.empty()) return "an error without a message";
  (void)chip.run_until(2000);
  return {};
}

}  // namespace kaz::h8s::fuzz
