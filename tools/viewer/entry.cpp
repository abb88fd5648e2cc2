// Access control of the server.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/entry.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

namespace kaz::viewer {
namespace {

bool same_text(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

// Takes the same time for every wrong secret.
bool equal_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ |= static_cast<unsigned>(a[i] ^ b[i]);
  return differ == 0;
}

enum class Token { none, right, wrong };

Token token_in(std::string_view target, const std::string& token) {
  constexpr std::string_view kName = "token=";
  const auto mark = target.find('?');
  Token found = Token::none;
  for (std::string_view rest = mark == target.npos ? "" : target.substr(mark + 1); !rest.empty();) {
    const auto end = rest.find('&');
    const std::string_view word = rest.substr(0, end);
    rest = end == rest.npos ? "" : rest.substr(end + 1);
    if (!word.starts_with(kName)) continue;
    if (!token.empty() && equal_secret(word.substr(kName.size()), token)) return Token::right;
    found = Token::wrong;
  }
  return found;
}

// Nobody but this machine's owner can make its own name or an IP address a web page's origin.
bool names_this_machine(std::string_view host, const std::vector<std::string>& names) {
  if (host.find('\0') != host.npos) return false;  // inet_pton() would ignore the rest
  const bool bracketed = host.starts_with('[');
  const auto end = bracketed ? host.find(']') : host.find(':');
  std::string_view port = end == host.npos ? "" : host.substr(end + bracketed);
  if (!port.empty() && !port.starts_with(':')) return false;
  port.remove_prefix(std::min<std::size_t>(1, port.size()));
  if (port.find_first_not_of("0123456789") != port.npos) return false;
  const std::string name(host.substr(bracketed, end == host.npos ? end : end - bracketed));
  in6_addr address{};
  if (bracketed) return end != host.npos && inet_pton(AF_INET6, name.c_str(), &address) == 1;
  if (inet_pton(AF_INET, name.c_str(), &address) == 1 || same_text(name, "localhost")) return true;
  return std::ranges::any_of(names, [&](const auto& own) { return same_text(own, name); });
}

// Browsers send the origin of the page, or "null" if the page hides it. Programs send no origin, or one that
// no web page can have ("file://"). An unknown form of "http" counts as a web page.
bool is_foreign_page(std::string_view origin, std::string_view host) {
  constexpr std::array<std::string_view, 2> kSchemes = {"http://", "https://"};
  if (!same_text(origin.substr(0, 4), "http")) return origin == "null";
  return std::ranges::none_of(kSchemes, [&](std::string_view scheme) {
    return same_text(origin.substr(0, scheme.size()), scheme) &&
           same_text(origin.substr(scheme.size()), host);
  });
}

Answer refusal(unsigned status, std::string_view sentence) {
  Answer answer;
  answer.status = status;
  answer.sentence = sentence;
  return answer;
}

}  // namespace

Answer answer_to(const HttpRequest& request, const Access& access) {
  if (!names_this_machine(request.host, access.names))
    return refusal(403,
                   "the Host header does not name this machine: open the address that kaz printed, "
                   "or write this machine's IP address instead of the host name\n");
  const Token token = token_in(request.target, access.token);
  const bool looks =
      token == Token::right || (access.open && !is_foreign_page(request.origin, request.host));
  const Answer no_access =
      refusal(403, token == Token::wrong
                       ? "wrong token: open the address that kaz printed\n"
                       : "no token: open the address that kaz printed, with its ?token=... at the "
                         "end; if kaz runs with --view-open, programs on this machine can watch "
                         "without a token\n");
  if (request.upgrade) {
    Answer answer;
    answer.status = 101;
    answer.control = token == Token::right;
    answer.subprotocol = chosen_subprotocol(request.subprotocols);
    if (answer.subprotocol.empty())
      return refusal(400, "this server speaks foxglove.sdk.v1 and foxglove.websocket.v1\n");
    return looks && token != Token::wrong ? answer : no_access;
  }
  if (request.method != "GET" && request.method != "HEAD")
    return refusal(405, "GET and HEAD only\n");
  const std::string path(request.target.substr(0, request.target.find('?')));
  Answer answer;
  if (const auto at = access.page.find(path == "/" ? "/index.html" : path);
      at != access.page.end()) {
    answer.file = &at->second;
    return answer;
  }
  const auto at = access.robot.find(path);
  if (at == access.robot.end()) return refusal(404, "page not found\n");
  if (!looks || token == Token::wrong) return no_access;
  answer.file = &at->second;
  answer.any_origin = true;
  return answer;
}

}  // namespace kaz::viewer
