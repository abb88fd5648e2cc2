// Which beginnings are a browser's, in pieces of any size.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/browser_guard.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kaz {
namespace {

// What was passed on, when `text` came in pieces of `piece` bytes; nothing: refused.
std::optional<std::string> passed(const std::string& text, std::size_t piece) {
  BrowserGuard guard;
  std::string all;
  for (std::size_t at = 0; at < text.size(); at += piece) {
    const std::string part = text.substr(at, piece);
    const auto some =
        guard.admit({reinterpret_cast<const std::uint8_t*>(part.data()), part.size()});
    if (!some) {
      EXPECT_EQ(all, "") << "something was passed on before " << text << " was refused";
      return std::nullopt;
    }
    all.append(some->begin(), some->end());
  }
  return all;
}

TEST(BrowserGuard, RefusesEachMethodAndTls) {
  for (const std::string method :
       {"GET", "HEAD", "POST", "PUT", "DELETE", "PATCH", "OPTIONS", "CONNECT", "TRACE"})
    for (const std::size_t piece : {1u, 2u, 3u, 1000u})
      EXPECT_EQ(passed(method + " / HTTP/1.1\r\n\r\n" + std::string(100, '\0'), piece),
                std::nullopt)
          << method << " in pieces of " << piece;
  EXPECT_EQ(passed("\x16\x03\x01", 1), std::nullopt);
}

TEST(BrowserGuard, PassesEverythingElseWholeAndAtOnce) {
  const std::string frame("\0\x02\x01\x88\0", 5);
  for (const std::string& text :
       {frame, std::string("\xff\xfb\x2c"), std::string("+$g#67"), std::string("\x03"),
        std::string("get / HTTP"), std::string("GETTER"), std::string("POSTBOX "),
        std::string("PO\0", 3), std::string("\x16\x16"), std::string(" GET / "),
        std::string("G28\n")})
    for (const std::size_t piece : {1u, 2u, 1000u}) EXPECT_EQ(passed(text, piece), text) << text;
}

// It may still become one, and no peer of ours sends it.
TEST(BrowserGuard, PassesNothingOfABeginningAlone) {
  for (const std::string text : {"P", "POST", "GET", "OPTIONS", "\x16"}) {
    EXPECT_EQ(passed(text, 1), "") << text;
    EXPECT_EQ(passed(text + "\n", 1), text + "\n") << "it was none";
  }
}

}  // namespace
}  // namespace kaz
