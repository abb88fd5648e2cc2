// What damage on the wire does: no damaged frame is accepted, every whole one is.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "shared/protocol/frame.h"

namespace {

using Bytes = std::vector<u8>;

Bytes frame_of(const Bytes& body) {
  Bytes wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

std::vector<Bytes> received(const Bytes& wire) {
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  std::vector<Bytes> bodies;
  for (const u8 byte : wire)
    if (kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME)
      bodies.emplace_back(receiver.body, receiver.body + receiver.length);
  return bodies;
}

// A body of any length, with many zeros or few.
Bytes random_body(std::mt19937& random) {
  Bytes body(KZ_HEADER_SIZE + random() % (KZ_PAYLOAD_MAX + 1));
  const unsigned zeros = random() % 8;
  for (u8& byte : body) byte = static_cast<u8>(random() % 8 < zeros ? 0 : random());
  return body;
}

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes whole;
  for (const Bytes& part : parts) whole.insert(whole.end(), part.begin(), part.end());
  return whole;
}

void append(Bytes& to, const Bytes& part) {
  to.insert(to.end(), part.begin(), part.end());
}

// A stream of frames, and which of its bytes belong to which frame: damage keeps count.
struct Stream {
  struct Byte {
    u8 value;
    int frame;
  };
  explicit Stream(std::mt19937& random) {
    for (int i = 0; i < 8; ++i) {
      bodies.push_back(random_body(random));
      bodies.back()[2] = static_cast<u8>(i);  // no two are the same
      for (const u8 value : frame_of(bodies.back())) bytes.push_back({value, i});
    }
    whole.assign(bodies.size(), true);
  }
  // `count` bytes from `place` become those of `with`: other ones, none, or more.
  void replace(std::size_t place, std::size_t count, const Bytes& with) {
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(place);
    const auto to = from + static_cast<std::ptrdiff_t>(std::min(count, bytes.size() - place));
    for (auto byte = from; byte != to; ++byte) spoil(byte->frame);
    // Bytes that come between two of one frame damage it too.
    if (from == to && from != bytes.begin() && from != bytes.end() &&
        from->frame == std::prev(from)->frame)
      spoil(from->frame);
    auto at = bytes.erase(from, to);
    for (const u8 value : with) at = std::next(bytes.insert(at, {value, -1}));
  }
  void spoil(int frame) {  // -1: a byte of none
    if (frame >= 0) whole[static_cast<std::size_t>(frame)] = false;
  }
  Bytes wire() const {
    Bytes values;
    for (const Byte& byte : bytes) values.push_back(byte.value);
    return values;
  }
  std::vector<Bytes> bodies;
  std::vector<Byte> bytes;
  std::vector<bool> whole;
};

// Whether all whole frames came, in order, and how many came that were never sent. A frame that has
// lost a zero of its own to a neighbour's may come too: its bytes are all there.
void check(const Stream& stream, int* strangers) {
  std::size_t next = 0;
  for (const Bytes& body : received(stream.wire())) {
    std::size_t at = next;
    while (at < stream.bodies.size() && stream.bodies[at] != body) ++at;
    if (at == stream.bodies.size()) {
      ++*strangers;
      continue;
    }
    for (; next < at; ++next) ASSERT_FALSE(stream.whole[next]) << "frame " << next << " is missing";
    next = at + 1;
  }
  for (; next < stream.bodies.size(); ++next)
    ASSERT_FALSE(stream.whole[next]) << "frame " << next << " is missing";
}

Bytes random_bytes(std::mt19937& random, std::size_t count) {
  Bytes bytes(count);
  for (u8& byte : bytes) byte = static_cast<u8>(random() % 4 ? random() : 0);
  return bytes;
}

TEST(Recovery, EveryWholeFrameIsReceivedAfterOneByteDamagedLostOrInserted) {
  int strangers = 0;
  for (unsigned seed = 0; seed < 10000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Stream stream(random);
    const std::size_t place = random() % stream.bytes.size();
    const unsigned kind = random() % 3;
    if (kind == 0) {
      const u8 other = static_cast<u8>(stream.bytes[place].value ^ (1 + random() % 255));
      stream.replace(place, 1, {other});
    } else if (kind == 1) {
      stream.replace(place, 1, {});
    } else {
      stream.replace(place, 0, random_bytes(random, 1));
    }
    ASSERT_NO_FATAL_FAILURE(check(stream, &strangers));
  }
  EXPECT_EQ(strangers, 0);
}

TEST(Recovery, EveryWholeFrameIsReceivedAfterBurstsOfUpTo20Bytes) {
  int damaged = 0, strangers = 0;
  for (unsigned seed = 0; seed < 10000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Stream stream(random);
    for (unsigned bursts = 1 + random() % 2; bursts != 0; --bursts) {
      const std::size_t place = random() % stream.bytes.size();
      const std::size_t length = 1 + random() % 20;
      const unsigned kind = random() % 3;  // other bytes; bytes lost; bytes inserted
      stream.replace(place, kind == 2 ? 0 : length,
                     kind == 1 ? Bytes{} : random_bytes(random, length));
    }
    damaged += static_cast<int>(std::count(stream.whole.begin(), stream.whole.end(), false));
    ASSERT_NO_FATAL_FAILURE(check(stream, &strangers));
  }
  EXPECT_GT(damaged, 10000);
  EXPECT_LE(strangers, 3) << "of " << damaged << " damaged frames; theory: one of 65536";
}

TEST(Recovery, NoFrameWithOneDamagedByteIsAcceptedAtAnyPlaceWithAnyValue) {
  std::mt19937 random(1);
  const Bytes before_body = {1, 6, 1, 0, 0}, after_body = {1, 5, 2};
  const Bytes before = frame_of(before_body), after = frame_of(after_body);
  const std::vector<Bytes> around = {before_body, after_body};
  int frames = 0;
  long long cases = 0;
  while (frames < 200) {
    const Bytes valid = frame_of(random_body(random));
    if (kz_frame_splits(valid.data(), static_cast<u8>(valid.size()))) continue;
    ++frames;
    Bytes wire = joined({before, valid, after});
    for (std::size_t place = before.size(); place < before.size() + valid.size(); ++place) {
      const u8 right = wire[place];
      for (int value = 0; value < 256; ++value) {
        if (value == right) continue;
        wire[place] = static_cast<u8>(value);
        ASSERT_EQ(received(wire), around)
            << "frame " << frames << ", byte " << place << " as " << value;
        ++cases;
      }
      wire[place] = right;
    }
  }
  EXPECT_GT(cases, 1000000);
}

// The one hole, and that kz_frame_splits sees it: a body of two pieces, where the CRC is back at its
// start behind the first.
TEST(Recovery, AFrameThatSplitsIsSeenBeforeItIsSent) {
  const Bytes second = {1, 7, 9};
  int found = 0;
  for (unsigned filling = 0; filling < 0x10000; ++filling) {
    const u8 high = static_cast<u8>(filling >> 8), low = static_cast<u8>(filling);
    if (high == 0 || low == 0) continue;
    const Bytes first = {1, 3, 8, high, low, 0x55};
    Bytes body = first;
    body.push_back(0);
    append(body, second);
    Bytes wire = frame_of(body);
    if (!kz_frame_splits(wire.data(), static_cast<u8>(wire.size()))) continue;
    const std::size_t last_of_first = 1 + first.size();
    u16 crc = 0xFFFF;
    for (std::size_t i = 1; i <= last_of_first; ++i) crc = kz_crc16(crc, wire[i]);
    if (crc != 0xFFFF) continue;
    ++found;
    EXPECT_EQ(received(wire), std::vector<Bytes>{body});
    wire[last_of_first] = 0;
    EXPECT_EQ(received(wire), std::vector<Bytes>{second});
  }
  EXPECT_GT(found, 0);
}

TEST(Recovery, FewFramesSplit) {
  std::mt19937 random(2);
  int splits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Bytes wire = frame_of(random_body(random));
    splits += kz_frame_splits(wire.data(), static_cast<u8>(wire.size()));
  }
  EXPECT_GT(splits, 0);
  EXPECT_LT(splits, 60);  // about 50 bytes each: 20000 * 50 / 65536 = 15
}

}  // namespace
