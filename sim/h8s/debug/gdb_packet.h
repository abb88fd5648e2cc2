// GDB's remote protocol, packet layer: framing, acknowledgements, hexadecimal numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kaz::h8s {

// One item of the byte stream.
struct GdbInput {
  enum class Kind {
    packet,     // `data`, with its checksum right and escapes resolved
    damaged,    // a packet whose checksum is wrong, or longer than kMaxPacket
    interrupt,  // Ctrl-C
    repeat,     // '-': the peer requests retransmission of the last packet
  };
  Kind kind = Kind::packet;
  std::string data;
};

inline constexpr std::size_t kMaxPacket = 0x4000;

class GdbFraming {
 public:
  // Accepts bytes in pieces of any size; acknowledgements and noise between packets are ignored.
  void feed(std::span<const std::uint8_t> bytes, std::vector<GdbInput>& to);

 private:
  enum class At { outside, inside, escaped, first_digit, second_digit };
  At at_ = At::outside;
  std::string data_;
  std::uint8_t sum_ = 0;
  int checksum_ = 0;  // as received
  bool too_long_ = false;
};

// "$data#xx"; the characters # $ } * are escaped.
std::string gdb_frame(std::string_view data);

std::string to_hex(std::span<const std::uint8_t> bytes);
std::string to_hex(std::string_view text);
// The packet that shows text on GDB's console.
std::string console_packet(std::string_view text);
// 8 digits, big-endian.
std::string hex32(std::uint32_t value);
// nullopt: odd length or not hexadecimal.
std::optional<std::vector<std::uint8_t>> from_hex(std::string_view digits);

// Parses a packet from front to back; functions consume nothing if the text does not match.
class GdbReader {
 public:
  explicit GdbReader(std::string_view text) : text_(text) {}
  bool take(std::string_view prefix);
  // 1 to 16 hexadecimal digits.
  std::optional<std::uint64_t> number();
  std::string_view rest() const { return text_; }
  bool empty() const { return text_.empty(); }

 private:
  std::string_view text_;
};

}  // namespace kaz::h8s
