// Packet layer of GDB's remote protocol: framing, acknowledgment, hexadecimal numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kaz::h8s {

// One item of the byte stream from GDB.
struct GdbInput {
  enum class Kind {
    packet,     // packet with a correct checksum; `data` is the content without escapes
    damaged,    // a packet with a wrong checksum, or longer than kMaxPacket
    interrupt,  // Ctrl-C
    repeat,     // '-': the peer requests retransmission of the last packet
  };
  Kind kind = Kind::packet;
  std::string data;
};

inline constexpr std::size_t kMaxPacket = 0x4000;  // bytes of data

class GdbFraming {
 public:
  // Parses bytes, in pieces of any size, and appends the items to `to`. Ignores acknowledgments and other
  // bytes between packets.
  void feed(std::span<const std::uint8_t> bytes, std::vector<GdbInput>& to);

 private:
  enum class At { outside, inside, escaped, first_digit, second_digit };
  At at_ = At::outside;
  std::string data_;
  std::uint8_t sum_ = 0;
  int checksum_ = 0;  // received checksum
  bool too_long_ = false;
};

// Returns the packet "$data#xx". The characters # $ } * are escaped.
std::string gdb_frame(std::string_view data);

std::string to_hex(std::span<const std::uint8_t> bytes);
std::string to_hex(std::string_view text);
// Returns the data of a packet that shows `text` on GDB's console.
std::string console_packet(std::string_view text);
// Returns 8 hexadecimal digits, most significant first.
std::string hex32(std::uint32_t value);
// Returns nullopt if the length is odd or a character is not a hexadecimal digit.
std::optional<std::vector<std::uint8_t>> from_hex(std::string_view digits);

// Parses a packet from front to back. A function that does not find the expected text consumes nothing.
class GdbReader {
 public:
  explicit GdbReader(std::string_view text) : text_(text) {}
  // Consumes `prefix`. Returns false if the text does not begin with `prefix`.
  bool take(std::string_view prefix);
  // Consumes 1 to 16 hexadecimal digits and returns their value.
  std::optional<std::uint64_t> number();
  std::string_view rest() const { return text_; }
  bool empty() const { return text_.empty(); }

 private:
  std::string_view text_;
};

}  // namespace kaz::h8s
