// Rejects connections from web browsers at TCP ports that do not speak HTTP.
// SPDX-License-Identifier: Apache-2.0
//
// Cross-protocol request: a web page can make the user's browser send any body to any TCP port that this
// machine reaches, including 127.0.0.1. With DNS rebinding, the page can also choose the HTTP method. The
// method can be any token of RFC 9110, even text that is valid in GDB's protocol. If a server does not speak
// HTTP, the server may skip the HTTP header as noise and then execute the body as commands.
//
// So each TCP listener that does not speak HTTP first passes received bytes through a BrowserGuard. The guard
// admits a connection only if the first bytes cannot come from a browser.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace kaz {

// Message for the user. The caller writes the client's name before this text.
inline constexpr std::string_view kBrowserRefused =
    "was disconnected, because its first bytes can come from a web browser; none of its bytes were "
    "passed on";

// Checks the first bytes of one connection. Not thread-safe.
class BrowserGuard {
 public:
  enum class Peer {
    // The guard refuses a connection if its first byte is a text character, because HTTP begins with text.
    // The guard also refuses a connection if its first byte is 22, because TLS begins with 22. Frames to a
    // board begin with 0; Telnet and servo bus packets begin with 255.
    frames,
    // The peer first sends one GDB packet, optionally after '+', and then waits for the reply. The packet has
    // up to kLongestFirst bytes, without spaces or line ends. Text from a browser cannot be such a packet,
    // because a space follows the HTTP method.
    gdb,
  };
  static constexpr std::size_t kLongestFirst = 1024;

  explicit BrowserGuard(Peer peer) : peer_(peer) {}

  // Checks the next received bytes. Returns the bytes to pass on, or nullopt if the peer may be a browser.
  // The caller must then close the connection. The result is valid until the next call of admit(), and only
  // as long as `bytes` exists. As long as the first GDB packet is incomplete, the result is empty. There is
  // no timeout for the first packet.
  std::optional<std::span<const std::uint8_t>> admit(std::span<const std::uint8_t> bytes) {
    if (admitted_ || bytes.empty()) return bytes;
    if (peer_ == Peer::frames) {
      if (is_text(bytes.front()) || bytes.front() == kTls) return std::nullopt;
      admitted_ = true;
      return bytes;
    }
    first_.insert(first_.end(), bytes.begin(), bytes.end());
    if (!may_be_gdb()) return std::nullopt;
    if (!admitted_) return std::span<const std::uint8_t>();
    return first_;
  }
  // Returns whether the connection was admitted.
  bool admitted() const { return admitted_; }

 private:
  static constexpr std::uint8_t kTls = 22;  // type of a handshake record

  static constexpr bool is_text(std::uint8_t byte) {
    return (byte >= 0x20 && byte < 0x7f) || (byte >= 9 && byte <= 13);
  }

  // Returns whether first_ may be the beginning of a GDB packet. Sets admitted_ if first_ is a whole packet:
  // "$...#xx".
  bool may_be_gdb() {
    std::span<const std::uint8_t> rest = first_;
    if (rest.front() == '+') rest = rest.subspan(1);
    if (rest.empty()) return true;
    if (rest.front() != '$' || rest.size() > kLongestFirst) return false;
    const auto end = std::ranges::find(rest, std::uint8_t{'#'});
    if (std::any_of(rest.begin(), end, [](std::uint8_t byte) { return byte <= ' '; })) return false;
    // Number of received bytes from '#' on; 3 if the packet is complete.
    const auto behind = rest.end() - end;
    admitted_ = behind == 3;
    return behind <= 3;
  }

  Peer peer_;
  std::vector<std::uint8_t> first_;  // first received bytes of a GDB connection
  bool admitted_ = false;
};

}  // namespace kaz
