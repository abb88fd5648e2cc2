// Framing: known vectors, every escape position, every damaged byte, and coming back into step.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

namespace {

using Bytes = std::vector<u8>;

Bytes encode(const Bytes& body) {
  Bytes wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

struct Receiver {
  Receiver() { kz_receiver_init(&state); }
  // Results other than KZ_RECEIVE_MORE, in order; bodies of valid frames are kept.
  void feed(const Bytes& wire) {
    for (const u8 byte : wire) feed_byte(byte, 0);
  }
  void feed_byte(u8 byte, u8 errors) {
    state.silent_ms = 0;
    keep(kz_receive(&state, byte, errors));
  }
  void silent(int ms) {
    for (; ms != 0; --ms) keep(kz_receiver_silent(&state));
  }
  void keep(u8 result) {
    if (result == KZ_RECEIVE_MORE) return;
    results.push_back(result);
    if (result == KZ_RECEIVE_FRAME) bodies.emplace_back(state.body, state.body + state.length);
  }
  kz_receiver state;
  std::vector<int> results;
  std::vector<Bytes> bodies;
};

std::vector<Bytes> received(const Bytes& wire) {
  Receiver receiver;
  receiver.feed(wire);
  return receiver.bodies;
}

Bytes joined(const Bytes& a, const Bytes& b) {
  Bytes both = a;
  both.insert(both.end(), b.begin(), b.end());
  return both;
}

TEST(Crc16, CheckValueOfTheCatalogue) {
  // CRC-16/IBM-3740 (also called CCITT-FALSE): poly 0x1021, init 0xFFFF, no reflection.
  u16 crc = 0xFFFF;
  for (const char c : {'1', '2', '3', '4', '5', '6', '7', '8', '9'})
    crc = kz_crc16(crc, static_cast<u8>(c));
  EXPECT_EQ(crc, 0x29B1);
}

TEST(Crc16, EveryTableEntryFollowsFromThePolynomial) {
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned remainder = byte << 8;
    for (int bit = 0; bit < 8; ++bit)
      remainder = (remainder & 0x8000 ? remainder << 1 ^ 0x1021 : remainder << 1) & 0xFFFF;
    EXPECT_EQ(kz_crc16(0, static_cast<u8>(byte)), remainder);
  }
}

TEST(Frame, StuffingOfThePublishedExamples) {
  // Pairs of body and stuffed body as in Cheshire and Baker's paper and its usual test vectors.
  const std::vector<std::pair<Bytes, Bytes>> cases = {
      {{0x00}, {0x01, 0x01}},
      {{0x00, 0x00}, {0x01, 0x01, 0x01}},
      {{0x11, 0x22, 0x00, 0x33}, {0x03, 0x11, 0x22, 0x02, 0x33}},
      {{0x11, 0x22, 0x33, 0x44}, {0x05, 0x11, 0x22, 0x33, 0x44}},
      {{0x11, 0x00, 0x00, 0x00}, {0x02, 0x11, 0x01, 0x01, 0x01}},
  };
  for (const auto& [body, stuffed] : cases) {
    const Bytes wire = encode(body);
    ASSERT_EQ(wire.size(), stuffed.size() + 5);
    EXPECT_EQ(wire.front(), 0);
    EXPECT_EQ(wire.back(), 0);
    EXPECT_EQ(Bytes(wire.begin() + 1, wire.begin() + 1 + static_cast<int>(stuffed.size())),
              stuffed);
  }
}

TEST(Frame, RoundTripOfAllBytePairs) {
  Receiver receiver;
  for (unsigned pair = 0; pair < 0x10000; ++pair) {
    const Bytes body = {static_cast<u8>(pair >> 8), static_cast<u8>(pair), 7};
    const Bytes wire = encode(body);
    ASSERT_EQ(std::count(wire.begin(), wire.end(), 0), 2);
    receiver.feed(wire);
    ASSERT_FALSE(receiver.bodies.empty());
    ASSERT_EQ(receiver.bodies.back(), body);
  }
  EXPECT_EQ(receiver.bodies.size(), 0x10000u);
}

TEST(Frame, RoundTripWithZerosAtEveryTwoPlacesOfEveryLength) {
  for (std::size_t length = KZ_HEADER_SIZE; length <= KZ_BODY_MAX; ++length) {
    for (std::size_t first = 0; first < length; ++first) {
      for (std::size_t second = first; second < length; second += 1 + length / 16) {
        Bytes body(length, 0xFF);
        body[first] = body[second] = 0;
        const Bytes wire = encode(body);
        ASSERT_LE(wire.size(), std::size_t{KZ_FRAME_MAX});
        ASSERT_EQ(std::count(wire.begin(), wire.end(), 0), 2);
        ASSERT_EQ(received(wire), std::vector<Bytes>{body});
      }
    }
  }
}

TEST(Frame, PieceByPieceGivesTheSameBytes) {
  const Bytes body = {1, 5, 0, 0, 7, 8, 0};
  const Bytes whole = encode(body);
  for (u8 room = 1; room <= 16; ++room) {
    kz_sender sender;
    kz_sender_init(&sender);
    std::copy(body.begin(), body.end(), sender.body);
    kz_sender_start(&sender, static_cast<u8>(body.size()));
    Bytes wire;
    while (kz_sender_busy(&sender)) {
      std::array<u8, 16> piece;
      const u8 count = kz_sender_take(&sender, piece.data(), room);
      ASSERT_LE(count, room);
      wire.insert(wire.end(), piece.begin(), piece.begin() + count);
    }
    EXPECT_EQ(wire, whole);
    std::array<u8, 4> nothing;
    EXPECT_EQ(kz_sender_take(&sender, nothing.data(), 4), 0);
  }
}

TEST(Frame, AnyDamagedByteInsideIsDetected) {
  const std::vector<Bytes> bodies = {{1, 1, 0},
                                     {1, 3, 9, 0, 0, 0, 1, 0, 100, 0, 50},
                                     Bytes(KZ_BODY_MAX, 0),
                                     Bytes(KZ_BODY_MAX, 1)};
  for (const Bytes& body : bodies) {
    const Bytes valid = encode(body);
    for (std::size_t place = 1; place + 1 < valid.size(); ++place) {
      for (unsigned value = 0; value < 256; ++value) {
        if (value == valid[place]) continue;
        Bytes damaged = valid;
        damaged[place] = static_cast<u8>(value);
        ASSERT_TRUE(received(damaged).empty()) << "byte " << place << " as " << value;
      }
    }
  }
}

TEST(Frame, ComesBackIntoStepAtTheNextFrame) {
  const Bytes first = encode({1, 3, 1, 0, 0, 0, 1, 7});
  const Bytes second_body = {1, 5, 2};
  const Bytes second = encode(second_body);
  for (std::size_t place = 0; place < first.size(); ++place) {
    Bytes lost = first;
    lost.erase(lost.begin() + static_cast<int>(place));
    EXPECT_EQ(received(joined(lost, second)).back(), second_body) << "lost byte " << place;
    for (const u8 extra : {0x00, 0x01, 0x80, 0xFF}) {
      Bytes gained = first;
      gained.insert(gained.begin() + static_cast<int>(place), extra);
      EXPECT_EQ(received(joined(gained, second)).back(), second_body) << "extra before " << place;
    }
    const Bytes tail(first.begin() + static_cast<int>(place), first.end());
    EXPECT_EQ(received(joined(tail, second)).back(), second_body) << "joined at " << place;
  }
}

TEST(Frame, ComesBackAfterNoise) {
  std::mt19937 random(1);
  const Bytes body = {1, 5, 2};
  for (int round = 0; round < 1000; ++round) {
    Bytes noise(random() % 300);
    for (u8& byte : noise) byte = static_cast<u8>(random());
    const auto bodies = received(joined(noise, encode(body)));
    ASSERT_FALSE(bodies.empty());
    EXPECT_EQ(bodies.back(), body);
  }
}

TEST(Frame, SaysWhatIsWrong) {
  Receiver receiver;
  Bytes bad_check = encode({1, 2, 3});
  bad_check[2] ^= 2;
  receiver.feed(bad_check);
  receiver.feed({0, 1, 2, 0});
  receiver.feed(encode({1, 2}));
  Bytes too_long(KZ_FRAME_MAX + 20, 0x11);
  too_long.front() = too_long.back() = 0;
  receiver.feed(too_long);
  EXPECT_EQ(receiver.results, (std::vector<int>{KZ_RECEIVE_BAD_CHECK, KZ_RECEIVE_TOO_SHORT,
                                                KZ_RECEIVE_TOO_SHORT, KZ_RECEIVE_TOO_LONG}));
}

TEST(Frame, BadStuffingWithARightCheck) {
  // A block that promises four bytes and has two; the check is right for what stands there.
  const Bytes stuffed = {5, 1, 2};
  u16 crc = 0xFFFF;
  for (const u8 byte : stuffed) crc = kz_crc16(crc, byte);
  const Bytes wire = {0,
                      5,
                      1,
                      2,
                      static_cast<u8>(0x80 | crc >> 14),
                      static_cast<u8>(0x80 | (crc >> 7 & 0x7F)),
                      static_cast<u8>(0x80 | (crc & 0x7F)),
                      0};
  Receiver receiver;
  receiver.feed(wire);
  EXPECT_EQ(receiver.results, std::vector<int>{KZ_RECEIVE_BAD_STUFFING});
}

TEST(Frame, ALineErrorSpoilsItsFrameOnly) {
  const Bytes wire = encode({1, 2, 3, 4});
  for (std::size_t place = 1; place + 1 < wire.size(); ++place) {
    Receiver receiver;
    for (std::size_t i = 0; i < wire.size(); ++i)
      receiver.feed_byte(wire[i], i == place ? KZ_RX_FRAMING : 0);
    receiver.feed(wire);
    EXPECT_EQ(receiver.results, (std::vector<int>{KZ_RECEIVE_LINE_ERROR, KZ_RECEIVE_FRAME}));
  }
}

TEST(Frame, ABreakBetweenFramesCostsNoFrame) {
  Receiver receiver;
  const Bytes wire = encode({1, 2, 3, 4});
  receiver.feed(wire);
  receiver.feed_byte(0, KZ_RX_FRAMING);  // zero with a framing error
  receiver.feed(wire);
  EXPECT_EQ(receiver.bodies.size(), 2u);
}

TEST(Frame, BytesLostBeforeOneSpoilTheFrameItStandsIn) {
  const Bytes wire = encode({1, 2, 3, 4});
  for (std::size_t place = 0; place < wire.size(); ++place) {
    Receiver receiver;
    receiver.feed(wire);
    for (std::size_t i = 0; i < wire.size(); ++i)
      receiver.feed_byte(wire[i], i == place ? KZ_RX_LOST : 0);
    receiver.feed(wire);
    // Before the opening zero another frame may have been lost; this one is whole.
    const int second = place == 0 ? KZ_RECEIVE_FRAME : KZ_RECEIVE_OVERRUN;
    std::vector<int> expected = {KZ_RECEIVE_FRAME, second, KZ_RECEIVE_FRAME};
    if (place == 0) expected.insert(expected.begin() + 1, KZ_RECEIVE_OVERRUN);
    EXPECT_EQ(receiver.results, expected) << place;
  }
}

TEST(Frame, BytesLostAfterOneSpoilTheFrameTheyStandIn) {
  const Bytes wire = encode({1, 2, 3, 4});
  for (std::size_t place = 0; place < wire.size(); ++place) {
    Receiver receiver;
    for (std::size_t i = 0; i < wire.size(); ++i)
      receiver.feed_byte(wire[i], i == place ? KZ_RX_OVERRUN : 0);
    receiver.feed(wire);
    std::vector<int> expected = {KZ_RECEIVE_OVERRUN, KZ_RECEIVE_FRAME};
    // After the closing zero the frame is whole, and what was lost stood before the next zero.
    if (place + 1 == wire.size()) expected.insert(expected.begin(), KZ_RECEIVE_FRAME);
    EXPECT_EQ(receiver.results, expected) << place;
  }
}

TEST(Frame, OfSeveralErrorsTheFirstCounts) {
  Receiver receiver;
  receiver.feed({0, 1, 2});
  receiver.feed_byte(3, KZ_RX_PARITY);
  receiver.feed_byte(4, KZ_RX_LOST);
  receiver.feed(Bytes(KZ_FRAME_MAX, 1));
  receiver.feed({0, 1, 2});
  receiver.feed_byte(3, KZ_RX_LOST);
  receiver.feed_byte(4, KZ_RX_FRAMING);
  receiver.silent(KZ_IDLE_MS);
  receiver.feed(Bytes(KZ_FRAME_MAX, 1));
  receiver.feed({0});
  EXPECT_EQ(receiver.results, (std::vector<int>{KZ_RECEIVE_LINE_ERROR, KZ_RECEIVE_OVERRUN}));
}

TEST(Frame, IsGivenUpAfterSilenceInIt) {
  const Bytes wire = encode({1, 2, 3, 4});
  for (std::size_t place = 2; place < wire.size(); ++place) {
    const auto pause = wire.begin() + static_cast<int>(place);
    Receiver receiver;
    receiver.feed(Bytes(wire.begin(), pause));
    receiver.silent(KZ_IDLE_MS - 1);
    EXPECT_TRUE(receiver.results.empty());
    receiver.silent(1);
    EXPECT_EQ(receiver.results, std::vector<int>{KZ_RECEIVE_IDLE});
    receiver.silent(1000);
    receiver.feed(Bytes(pause, wire.end()));  // the rest, late: nothing
    receiver.feed(wire);
    EXPECT_EQ(receiver.results, (std::vector<int>{KZ_RECEIVE_IDLE, KZ_RECEIVE_FRAME}));
  }
}

TEST(Frame, ShorterPausesAndSilenceBetweenFramesDoNoHarm) {
  const Bytes wire = encode({1, 2, 3, 4});
  Receiver receiver;
  for (int round = 0; round < 2; ++round) {
    for (const u8 byte : wire) {
      receiver.feed({byte});
      receiver.silent(KZ_IDLE_MS - 1);
    }
    receiver.silent(1000);
  }
  receiver.feed({0});
  receiver.silent(1000);
  receiver.feed(wire);
  EXPECT_EQ(receiver.results, std::vector<int>(3, KZ_RECEIVE_FRAME));
}

TEST(Frame, ManyBytesAtOnceAreAsOneByOne) {
  std::mt19937 random(3);
  Receiver one_by_one;
  std::vector<int> results;
  std::vector<Bytes> bodies;
  kz_receiver many;
  kz_receiver_init(&many);
  for (int round = 0; round < 20000; ++round) {
    Bytes body(KZ_HEADER_SIZE + random() % 20);
    for (u8& byte : body) byte = static_cast<u8>(random() % 4 ? random() : 0);
    Bytes bytes = random() % 8 ? encode(body) : Bytes(random() % 150, 0x55);
    if (random() % 8 == 0) bytes.resize(random() % (bytes.size() + 1));
    Bytes errors(bytes.size());
    for (u8& error : errors)
      if (random() % 64 == 0) error = static_cast<u8>(KZ_RX_LOST << random() % 4);
    for (std::size_t i = 0; i < bytes.size(); ++i) one_by_one.feed_byte(bytes[i], errors[i]);
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t size = std::min<std::size_t>(bytes.size() - at, 1 + random() % 16);
      const u16 some = kz_receive_some(&many, &bytes[at], &errors[at], static_cast<u8>(size));
      ASSERT_GE(some & 0xFF, 1);
      ASSERT_LE(some & 0xFF, static_cast<int>(size));
      at += some & 0xFF;
      if (some >> 8 == KZ_RECEIVE_MORE) continue;
      results.push_back(some >> 8);
      if (some >> 8 == KZ_RECEIVE_FRAME) bodies.emplace_back(many.body, many.body + many.length);
    }
  }
  EXPECT_EQ(std::set<int>(results.begin(), results.end()).size(),
            6u);  // all but IDLE and BAD_STUFFING
  EXPECT_EQ(results, one_by_one.results);
  EXPECT_EQ(bodies, one_by_one.bodies);
}

}  // namespace
