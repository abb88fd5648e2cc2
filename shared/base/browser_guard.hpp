// Keeps web pages out of TCP ports that do not speak HTTP.
// SPDX-License-Identifier: Apache-2.0
//
// A page in the user's browser can send a request to any TCP port that this machine reaches, 127.0.0.1
// included, with a body of its choice (a cross-protocol request). A page whose name is rebound to this
// machine also chooses the method: any token of RFC 9110, which may be text of GDB's protocol. To a server
// of raw bytes the header is noise, and the body is obeyed. So each TCP listener that does not speak HTTP
// passes what a client sends through a BrowserGuard first, which knows how its own peers begin.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace kaz {

// For the user, after the client's name.
inline constexpr std::string_view kBrowserRefused =
    "was disconnected: it began as a web browser may, and not as a client of this port does; "
    "nothing "
    "was passed on";

// One for each connection. Not thread-safe.
class BrowserGuard {
 public:
  enum class Peer {
    // A board's frame begins with 0, Telnet and the packets of servo buses with 255: any byte but those of
    // text, with which HTTP begins, and 22, with which TLS does.
    frames,
    // Begins with one packet, with or without '+' before it, and waits for the answer. A browser goes on with
    // a space and a path. The first packet has up to kLongestFirst bytes, and no spaces or line ends.
    gdb,
  };
  static constexpr std::size_t kLongestFirst = 1024;

  explicit BrowserGuard(Peer peer) : peer_(peer) {}

  // `bytes`: what has come next. Returns what may be passed on, valid until the next call or until `bytes`
  // end; nothing if a browser may be at the other end: pass nothing on and close the connection. The result
  // is empty while GDB's first packet is not complete. There is no timeout: a client that sends a part of it
  // and then no more has sent nothing.
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
  // Whether something was passed on.
  bool admitted() const { return admitted_; }

 private:
  static constexpr std::uint8_t kTls = 22;  // a record of a handshake

  static constexpr bool is_text(std::uint8_t byte) {
    return (byte >= 0x20 && byte < 0x7f) || (byte >= 9 && byte <= 13);
  }

  // Sets admitted_ where first_ is a whole packet: "$...#xx".
  bool may_be_gdb() {
    std::span<const std::uint8_t> rest = first_;
    if (rest.front() == '+') rest = rest.subspan(1);
    if (rest.empty()) return true;
    if (rest.front() != '$' || rest.size() > kLongestFirst) return false;
    const auto end = std::ranges::find(rest, std::uint8_t{'#'});
    if (std::any_of(rest.begin(), end, [](std::uint8_t byte) { return byte <= ' '; })) return false;
    const auto behind = rest.end() - end;  // '#' and two digits
    admitted_ = behind == 3;
    return behind <= 3;
  }

  Peer peer_;
  std::vector<std::uint8_t> first_;  // of GDB
  bool admitted_ = false;
};

}  // namespace kaz
