// Which beginnings are a browser's, in pieces of any size.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/browser_guard.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kaz {
namespace {

using Peer = BrowserGuard::Peer;

// What was passed on, when `text` came in pieces of `piece` bytes; nothing: refused.
std::optional<std::string> passed(Peer peer, const std::string& text, std::size_t piece) {
  BrowserGuard guard(peer);
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

// A page whose name is rebound chooses any token of RFC 9110 as its method, in any case.
TEST(BrowserGuard, RefusesEveryMethodAndTls) {
  for (const std::string method : {"GET", "POST", "PROPFIND", "patch", "X", "+", "$", "+$", "$g#67",
                                   "!", "+$g#67+$c#63", "1", "PRI"})
    for (const std::size_t piece : {1000u, 1u}) {
      const std::string request = method + " /x HTTP/1.1\r\n\r\n" + std::string(100, '\0') + "#00";
      EXPECT_EQ(passed(Peer::frames, request, piece), std::nullopt) << method;
      // One packet as the method, byte by byte, is what GDB sends.
      if (piece == 1 && method.find("#67") != std::string::npos) continue;
      EXPECT_EQ(passed(Peer::gdb, request, piece), std::nullopt)
          << method << ", pieces of " << piece;
    }
  for (const Peer peer : {Peer::frames, Peer::gdb})
    EXPECT_EQ(passed(peer, "\x16\x03\x01", 1), std::nullopt);
}

TEST(BrowserGuard, PassesFramesWholeAndAtOnce) {
  for (const std::string& text : {std::string("\0\x02\x01\x88\0", 5), std::string("\xff\xfb\x2c"),
                                  std::string("\xff\xffGET / ")})
    for (const std::size_t piece : {1u, 2u, 1000u})
      EXPECT_EQ(passed(Peer::frames, text, piece), text) << text;
}

TEST(BrowserGuard, PassesGdbOnceItsFirstPacketIsWhole) {
  for (const std::string text : {"$g#67", "+$g#67", "+$qSupported:multiprocess+;swbreak+#c6"}) {
    for (const std::size_t piece : {1u, 2u, 1000u}) EXPECT_EQ(passed(Peer::gdb, text, piece), text);
    EXPECT_EQ(passed(Peer::gdb, text.substr(0, text.size() - 1), 2), "") << "not complete yet";
  }
  EXPECT_EQ(passed(Peer::gdb, "+", 1), "");
  EXPECT_EQ(
      passed(Peer::gdb, std::string("$") + std::string(BrowserGuard::kLongestFirst, 'g'), 100),
      std::nullopt);
}

// GDB waits for an answer first.
TEST(BrowserGuard, RefusesWhatGoesOnBehindTheFirstPacket) {
  EXPECT_EQ(passed(Peer::gdb, "$g#67 ", 1000), std::nullopt);
  EXPECT_EQ(passed(Peer::gdb, "$g#67+$c#63", 1000), std::nullopt);
  EXPECT_EQ(passed(Peer::gdb, "+$M /x HTTP/1.1\r\nHost: a\r\nA: 00#00", 1000), std::nullopt);
}

}  // namespace
}  // namespace kaz
