// Reads serial:PATH[@BAUD], can:INTERFACE, tcp:HOST:PORT and rfc2217:HOST:PORT[@BAUD].
// SPDX-License-Identifier: Apache-2.0
#include "host/link/port_address.h"

#include <net/if.h>

#include <algorithm>
#include <array>
#include <utility>

#include "shared/base/number_text.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::host {

namespace {

constexpr std::array<std::pair<std::string_view, PortKind>, 4> kKinds = {
    {{"serial:", PortKind::serial},
     {"can:", PortKind::can},
     {"tcp:", PortKind::tcp},
     {"rfc2217:", PortKind::rfc2217}}};

// As the kernel judges names of interfaces (dev_valid_name).
bool names_interface(std::string_view text) {
  return !text.empty() && text.size() < IFNAMSIZ && text != "." && text != ".." &&
         std::ranges::none_of(text,
                              [](char c) { return c == '/' || c == ':' || c <= ' ' || c == 0x7f; });
}

// "HOST:PORT" in parts.
std::string read_host(std::string_view text, PortAddress& address) {
  std::string_view host;
  if (text.starts_with('[')) {
    const auto end = text.find(']');
    if (end == std::string_view::npos) return "the IPv6 address has no closing bracket";
    host = text.substr(1, end - 1);
    text.remove_prefix(end + 1);
  } else {
    const auto colon = text.find(':');
    if (colon != text.rfind(':')) return "put an IPv6 address in brackets, as in tcp:[::1]:7000";
    host = text.substr(0, colon);
    text = colon == std::string_view::npos ? std::string_view() : text.substr(colon);
  }
  if (host.empty()) return "the host is missing";
  constexpr std::string_view kInvalid = "/@[]\x7f";
  if (std::ranges::any_of(
          host, [&](char c) { return c <= ' ' || kInvalid.find(c) != std::string_view::npos; }))
    return "the host name has invalid characters";
  if (!text.starts_with(':')) return "the port number is missing";
  const auto port = parse_number<int>(text.substr(1));
  if (!port || *port < 1 || *port > 65535) return "the port must be 1 to 65535";
  address.place = host;
  address.tcp_port = static_cast<std::uint16_t>(*port);
  return "";
}

std::string read_rate(std::string_view& text, PortAddress& address) {
  const auto at = text.rfind('@');
  if (at == std::string_view::npos) return "";
  const auto baud = parse_number<int>(text.substr(at + 1));
  if (!baud || *baud <= 0) return "after @ give the bit rate, as in @115200";
  address.baud = *baud;
  text = text.substr(0, at);
  return "";
}

std::string read_place(std::string_view text, PortAddress& address) {
  switch (address.kind) {
    case PortKind::serial:
      if (auto wrong = read_rate(text, address); !wrong.empty()) return wrong;
      address.place = text;
      if (text.find('\0') != std::string_view::npos) return "the path must not have a zero byte";
      return text.empty() ? "the path of the port is missing" : "";
    case PortKind::can:
      address.place = text;
      if (text.empty()) return "the interface is missing";
      return names_interface(text) ? "" : "the text after can: is not a network interface name";
    case PortKind::rfc2217:
      if (auto wrong = read_rate(text, address); !wrong.empty()) return wrong;
      [[fallthrough]];
    case PortKind::tcp:
      return read_host(text, address);
  }
  return "";
}

}  // namespace

std::string PortAddress::name() const {
  if (kind == PortKind::serial) {
    // The bare path, unless it could be parsed as another kind of port or a servo bus, such as "feetech:a".
    std::string text = place.find(':') < place.find('/') ? "serial:" + place : place;
    return place.find('@') == std::string::npos ? text : text + "@" + std::to_string(baud);
  }
  if (kind == PortKind::can) return "can:" + place;
  const bool v6 = place.find(':') != std::string::npos;
  std::string text = kind == PortKind::tcp ? "tcp:" : "rfc2217:";
  text.append(v6 ? "[" : "").append(place).append(v6 ? "]:" : ":");
  return text.append(std::to_string(tcp_port));
}

bool names_port_kind(std::string_view text) {
  return std::ranges::any_of(kKinds,
                             [&](const auto& kind) { return text.starts_with(kind.first); });
}

std::string robot_option(std::string_view port_name) {
  std::string option = names_port_kind(port_name) ? "--robot " : "--robot serial:";
  return option.append(port_name);
}

Result<PortAddress> parse_port_address(const std::string& option, std::string_view text) {
  PortAddress address;
  std::string_view rest = text;
  for (const auto& [prefix, kind] : kKinds) {
    if (!text.starts_with(prefix)) continue;
    address.kind = kind;
    rest.remove_prefix(prefix.size());
  }
  if (const auto wrong = read_place(rest, address); !wrong.empty())
    return fail(Fault::usage, option + " " + cut_text(one_line(text)) + ": " + wrong +
                                  "; give serial:PATH or serial:PATH@BAUD, can:INTERFACE, "
                                  "tcp:HOST:PORT or rfc2217:HOST:PORT");
  return address;
}

}  // namespace kaz::host
