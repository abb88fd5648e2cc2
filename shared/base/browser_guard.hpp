// Keeps web pages out of TCP ports that do not speak HTTP.
// SPDX-License-Identifier: Apache-2.0
//
// A page in the user's browser can send a request to any TCP port that this machine reaches, 127.0.0.1
// included, with a body of its choice (a cross-protocol request). To a server of raw bytes the header is
// noise, and the body is obeyed. So each TCP listener that does not speak HTTP passes what a client sends
// through a BrowserGuard first. No valid peer of ours begins like a browser: a board's frame begins with 0,
// Telnet and the packets of servo buses with 255, a packet of GDB with '+' or '$'.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace kaz {

// For the user, after the client's name.
inline constexpr std::string_view kBrowserRefused =
    "was disconnected: it began with HTTP or TLS, as a web browser does, which this port does not "
    "speak; "
    "nothing was passed on";

// One for each connection. Not thread-safe.
class BrowserGuard {
 public:
  // `bytes`: what has come next. Returns what may be passed on, valid until the next call or until `bytes`
  // end; nothing if a browser is at the other end: pass nothing on and close the connection. The result is
  // empty while all that has come is the beginning of a request's first word. There is no timeout: a client
  // that sends such a beginning and then no more has sent nothing.
  std::optional<std::span<const std::uint8_t>> admit(std::span<const std::uint8_t> bytes) {
    if (admitted_) return bytes;
    first_.insert(first_.end(), bytes.begin(), bytes.end());
    for (const std::string_view beginning : kBeginnings) {
      const std::size_t count = std::min(beginning.size(), first_.size());
      const auto same = [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); };
      if (!std::equal(first_.begin(), first_.begin() + static_cast<std::ptrdiff_t>(count),
                      beginning.begin(), same))
        continue;
      if (count == beginning.size()) return std::nullopt;
      return std::span<const std::uint8_t>();
    }
    admitted_ = true;
    return first_;
  }
  // Whether something was passed on.
  bool admitted() const { return admitted_; }

 private:
  // RFC 9110 section 9.3 and RFC 5789; TLS: a record of a handshake. None is the beginning of another.
  static constexpr std::string_view kBeginnings[] = {
      "GET ",   "HEAD ",    "POST ",    "PUT ",   "DELETE ",
      "PATCH ", "OPTIONS ", "CONNECT ", "TRACE ", {"\x16\x03", 2}};

  std::vector<std::uint8_t> first_;
  bool admitted_ = false;
};

}  // namespace kaz
