// GDB's remote protocol, packet layer: framing, acknowledgements, hexadecimal numbers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/gdb_packet.h"

#include <cstdio>

namespace kaz::h8s {
namespace {

constexpr char kEscape = '}';

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

void GdbFraming::feed(std::span<const std::uint8_t> bytes, std::vector<GdbInput>& to) {
  for (const std::uint8_t byte : bytes) {
    const char c = static_cast<char>(byte);
    switch (at_) {
      case At::outside:
        if (c == '$') {
          at_ = At::inside;
          data_.clear();
          sum_ = 0;
          too_long_ = false;
        } else if (byte == 0x03) {
          to.push_back({GdbInput::Kind::interrupt, {}});
        } else if (c == '-') {
          to.push_back({GdbInput::Kind::repeat, {}});
        }
        break;
      case At::inside:
      case At::escaped:
        if (c == '#' && at_ == At::inside) {
          at_ = At::first_digit;
          break;
        }
        sum_ = static_cast<std::uint8_t>(sum_ + byte);
        if (c == kEscape && at_ == At::inside) {
          at_ = At::escaped;
          break;
        }
        if (data_.size() < kMaxPacket)
          data_ += at_ == At::escaped ? static_cast<char>(byte ^ 0x20) : c;
        else
          too_long_ = true;
        at_ = At::inside;
        break;
      case At::first_digit:
        checksum_ = digit(c) * 16;
        at_ = At::second_digit;
        break;
      case At::second_digit: {
        const int low = digit(c);
        const bool good = checksum_ >= 0 && low >= 0 && checksum_ + low == sum_ && !too_long_;
        to.push_back({good ? GdbInput::Kind::packet : GdbInput::Kind::damaged, std::move(data_)});
        data_.clear();
        at_ = At::outside;
        break;
      }
    }
  }
}

std::string gdb_frame(std::string_view data) {
  std::string text = "$";
  unsigned sum = 0;
  const auto put = [&](char c) {
    text += c;
    sum += static_cast<std::uint8_t>(c);
  };
  for (const char c : data) {
    if (c == '#' || c == '$' || c == '}' || c == '*') {
      put(kEscape);
      put(static_cast<char>(c ^ 0x20));
    } else {
      put(c);
    }
  }
  char end[8];
  std::snprintf(end, sizeof end, "#%02x", sum & 0xff);
  return text + end;
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t b : bytes) {
    text += kDigits[b >> 4];
    text += kDigits[b & 15];
  }
  return text;
}

std::string to_hex(std::string_view text) {
  return to_hex(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

std::string console_packet(std::string_view text) {
  std::string packet(1, 'O');
  packet += to_hex(text);
  return packet;
}

std::string hex32(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "%08x", value);
  return text;
}

std::optional<std::vector<std::uint8_t>> from_hex(std::string_view digits) {
  if (digits.size() % 2 != 0) return std::nullopt;
  std::vector<std::uint8_t> bytes;
  for (std::size_t k = 0; k < digits.size(); k += 2) {
    const int high = digit(digits[k]), low = digit(digits[k + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
  }
  return bytes;
}

bool GdbReader::take(std::string_view prefix) {
  if (text_.substr(0, prefix.size()) != prefix) return false;
  text_.remove_prefix(prefix.size());
  return true;
}

std::optional<std::uint64_t> GdbReader::number() {
  std::uint64_t value = 0;
  std::size_t n = 0;
  while (n < text_.size() && digit(text_[n]) >= 0) {
    if (n == 16) return std::nullopt;
    value = value << 4 | static_cast<std::uint64_t>(digit(text_[n]));
    ++n;
  }
  if (n == 0) return std::nullopt;
  text_.remove_prefix(n);
  return value;
}

}  // namespace kaz::h8s
