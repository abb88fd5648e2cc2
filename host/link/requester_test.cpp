// Window, order and repetitions, against the real servo code behind a line that loses frames.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/requester.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "host/link/board_testing.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

Request request_of(std::uint8_t type, std::initializer_list<std::uint8_t> fields = {}) {
  Request request;
  request.type = type;
  std::copy(fields.begin(), fields.end(), request.fields.bytes.begin());
  request.fields.length = static_cast<std::uint8_t>(fields.size());
  return request;
}

Request ramp_of(u16 ramp) {
  Request request;
  request.type = KZ_TYPE_limits;
  const kz_limits message{1, ramp, -32768, 32767};
  request.fields.length = kz_pack_limits(&message, request.fields.bytes.data());
  return request;
}

u16 ramp_in(const Reply& reply) {
  kz_settings_reply settings{};
  EXPECT_TRUE(kz_unpack_settings_reply(&settings, reply.fields.bytes.data(), reply.fields.length));
  return settings.ramp;
}

using Bodies = std::vector<std::vector<std::uint8_t>>;

Bodies bodies_of(const TestBoard::Bytes& bytes) {
  Bodies bodies;
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  for (const std::uint8_t byte : bytes) {
    if (kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME)
      bodies.emplace_back(receiver.body, receiver.body + receiver.length);
  }
  return bodies;
}

TestBoard::Bytes framed(const std::vector<std::uint8_t>& body) {
  TestBoard::Bytes wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

struct Requesting : ::testing::Test {
  TestBoard board;
  Requester requester{board, board, {}};

  // Frames in a chunk of bytes.
  static int frames(const TestBoard::Bytes& bytes) {
    return static_cast<int>(bodies_of(bytes).size());
  }
  void switch_on() {
    const Request on[] = {request_of(KZ_TYPE_clear), request_of(KZ_TYPE_enable, {0, 0, 0, 1})};
    ASSERT_TRUE(requester.exchange(on));
    const Request look[] = {request_of(KZ_TYPE_state)};
    ASSERT_TRUE(requester.exchange(look));
    ASSERT_TRUE(board.motors_on());
  }
};

TEST_F(Requesting, TwoQueriesLeaveTogetherAndTheThirdWaits) {
  std::vector<int> written;
  board.to_board = [&](TestBoard::Bytes bytes) {
    written.push_back(frames(bytes));
    return bytes;
  };
  const std::vector<Request> five(5, request_of(KZ_TYPE_state));
  const auto replies = requester.exchange(five);
  ASSERT_TRUE(replies) << replies.error().message;
  EXPECT_EQ(written, (std::vector<int>{2, 1, 1, 1}));
  EXPECT_EQ(requester.statistics().retries, 0u);
  EXPECT_EQ(requester.statistics().busy, 0u);
  // The replies fill the wire: 53 bytes each, a tick or two of the board's between them.
  const Time took = replies->back().received - replies->front().sent;
  EXPECT_LT(took, 5 * 53 * board.byte_time() + 9ms);
}

TEST_F(Requesting, BatchHasNoBytesBetweenItsFrames) {
  TestBoard::Bytes written;
  board.to_board = [&](TestBoard::Bytes bytes) {
    written.insert(written.end(), bytes.begin(), bytes.end());
    return bytes;
  };
  const Request requests[] = {request_of(KZ_TYPE_heartbeat, {0, 0}), request_of(KZ_TYPE_state)};
  ASSERT_TRUE(requester.exchange(requests));
  EXPECT_EQ(written.size(), 11u + 9u);
}

// Each command in turn is lost, or its reply; whatever was posted behind it, commands are done in
// order, and each once.
TEST_F(Requesting, RepeatedCommandNeverOvertakesANewerOne) {
  for (int lost = 0; lost < 12; ++lost) {
    for (const bool reply_lost : {false, true}) {
      int count = 0;
      const auto drop = [&](TestBoard::Bytes bytes) {
        return count++ == lost ? TestBoard::Bytes{} : bytes;
      };
      (reply_lost ? board.to_host : board.to_board) = drop;
      const Request requests[] = {ramp_of(11), request_of(KZ_TYPE_state),
                                  ramp_of(22), request_of(KZ_TYPE_settings, {0}),
                                  ramp_of(33), request_of(KZ_TYPE_settings, {0})};
      const auto replies = requester.exchange(requests);
      board.to_host = board.to_board = nullptr;
      ASSERT_TRUE(replies) << replies.error().message;
      const u16 second = ramp_in((*replies)[3]), third = ramp_in((*replies)[5]);
      // The first query may come after the command behind it, never before the one ahead of it.
      EXPECT_TRUE(second == 22 || second == 33) << second << ", lost " << lost;
      EXPECT_EQ(third, 33) << "lost " << lost;
      const Request now[] = {request_of(KZ_TYPE_settings, {0})};
      EXPECT_EQ(ramp_in(requester.exchange(now)->front()), 33);
    }
  }
  const Request query[] = {request_of(KZ_TYPE_statistics)};
  const auto reply = requester.exchange(query);
  kz_statistics_reply counts{};
  ASSERT_TRUE(kz_unpack_statistics_reply(&counts, reply->front().fields.bytes.data(),
                                         reply->front().fields.length));
  EXPECT_EQ(counts.refusals, 0);
}

// The reply to a query sent after a lost command reveals the loss long before the command's time-out.
TEST_F(Requesting, LossIsDetectedByTheReplyToALaterQuery) {
  const Request warm[] = {request_of(KZ_TYPE_state)};
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(requester.exchange(warm));
  bool first = true;
  board.to_board = [&](TestBoard::Bytes bytes) {
    if (std::exchange(first, false)) bytes[3] ^= 1;  // of the first of two frames
    return bytes;
  };
  const Request pair[] = {ramp_of(11), request_of(KZ_TYPE_state)};
  const Time before = board.now();
  ASSERT_TRUE(requester.exchange(pair));
  EXPECT_LT(board.now() - before, 20ms) << "the shortest time-out, and what comes after it";
  EXPECT_EQ(requester.statistics().retries, 2u) << "the command, and the query behind it";
  EXPECT_EQ(requester.statistics().timeouts, 0u);
}

TEST_F(Requesting, TimeOutIsThatOfTheRoundTrip) {
  const Request state[] = {request_of(KZ_TYPE_state)};
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(requester.exchange(state));
  const RoundTripStatistics trips = requester.statistics().round_trip;
  EXPECT_GT(trips.min_s, 62 * seconds(board.byte_time()));
  EXPECT_LT(trips.max_s, 62 * seconds(board.byte_time()) + 3e-3);
  bool first = true;
  board.to_board = [&](TestBoard::Bytes bytes) {
    return std::exchange(first, false) ? TestBoard::Bytes{} : bytes;
  };
  const Time before = board.now();
  ASSERT_TRUE(requester.exchange(state));
  EXPECT_EQ(requester.statistics().timeouts, 1u);
  EXPECT_GT(board.now() - before, 20ms + 5ms);
  EXPECT_LT(board.now() - before, 20ms + 9ms);
}

// Adapters that hold bytes back make each round trip long: after a few, nothing is sent twice.
TEST(Requester, LearnsOfASlowLine) {
  TestBoard::Options options;
  options.latency_to_board = options.latency_to_host = 60ms;
  TestBoard board(options);
  Requester requester(board, board, {});
  const Request state[] = {request_of(KZ_TYPE_state)};
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(requester.exchange(state));
  const auto before = requester.statistics().retries;
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(requester.exchange(state));
  EXPECT_LT(requester.statistics().retries - before, 10u);
  EXPECT_GT(requester.statistics().round_trip.mean_s, 0.03);
}

TEST_F(Requesting, StopOvertakesWhatWaits) {
  std::vector<std::uint8_t> types;
  board.to_board = [&](TestBoard::Bytes bytes) {
    for (const auto& body : bodies_of(bytes)) types.push_back(body[1]);
    return bytes;
  };
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(requester.post(request_of(KZ_TYPE_state)));
  const auto stopped = requester.exchange_at_once(request_of(KZ_TYPE_stop));
  ASSERT_TRUE(stopped) << stopped.error().message;
  EXPECT_FALSE(stopped->refused);
  ASSERT_GE(types.size(), 3u);
  EXPECT_EQ(types[2], KZ_TYPE_stop);
}

TEST_F(Requesting, PostedRequestsAreCollectedByTicket) {
  const auto first = requester.post(request_of(KZ_TYPE_state));
  const auto second = requester.post(request_of(KZ_TYPE_heartbeat, {0, 0}));
  ASSERT_TRUE(first && second);
  const auto nothing = requester.collect(*first, board.now() + 1ms);
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(*nothing);
  const auto later = requester.collect(*second, board.now() + 50ms);
  ASSERT_TRUE(later && *later);
  EXPECT_EQ((*later)->fields.length, KZ_SIZE_heartbeat_reply);
  const auto earlier = requester.collect(*first, board.now());
  ASSERT_TRUE(earlier && *earlier);
  EXPECT_EQ((*earlier)->fields.length, KZ_SIZE_state_reply);
  EXPECT_FALSE(requester.collect(*first, board.now())) << "each ticket gives its reply once";
}

TEST_F(Requesting, SequenceNumbersLeapAtANewStart) {
  std::set<std::uint8_t> numbers;
  board.to_board = [&](TestBoard::Bytes bytes) {
    for (const auto& body : bodies_of(bytes)) numbers.insert(body[2]);
    return bytes;
  };
  const Request state[] = {request_of(KZ_TYPE_state)};
  for (int i = 0; i < 3; ++i) {
    requester.start_anew();
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(requester.exchange(state));
  }
  EXPECT_EQ(numbers.size(), 30u);
}

// Three leaps in a row come back to the number just used.
TEST_F(Requesting, NoRequestHasANumberOfTheLastSixteen) {
  std::vector<std::uint8_t> numbers;
  board.to_board = [&](TestBoard::Bytes bytes) {
    for (const auto& body : bodies_of(bytes)) numbers.push_back(body[2]);
    return bytes;
  };
  for (int i = 0; i < 200; ++i) {
    for (int leaps = i % 4; leaps > 0; --leaps) requester.start_anew();
    ASSERT_TRUE(requester.send(request_of(KZ_TYPE_stop)));
  }
  ASSERT_EQ(numbers.size(), 200u);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = i - std::min<std::size_t>(i, 16); k < i; ++k)
      EXPECT_NE(numbers[i], numbers[k]) << i << " and " << k;
  }
}

TEST_F(Requesting, EachTransmissionThatOnlySwitchesOffHasItsOwnNumber) {
  const struct {
    Request request;
    bool fresh;
  } all[] = {{request_of(KZ_TYPE_stop), true},
             {request_of(KZ_TYPE_enable, {0, 0, 0, 0}), true},
             {request_of(KZ_TYPE_unlock, {KZ_KEY >> 8, KZ_KEY & 0xFF, 0}), true},
             {request_of(KZ_TYPE_raw_drive, {5, 0, 0, 0, 9}), true},
             {request_of(KZ_TYPE_enable, {0, 0, 0, 1}), false},
             {request_of(KZ_TYPE_unlock, {KZ_KEY >> 8, KZ_KEY & 0xFF, 1}), false},
             {request_of(KZ_TYPE_raw_drive, {0, 0, 1, 0, 9}), false}};
  for (const auto& one : all) {
    std::set<std::uint8_t> numbers;
    int lost = 2;
    board.to_board = [&](TestBoard::Bytes bytes) {
      for (const auto& body : bodies_of(bytes)) numbers.insert(body[2]);
      return lost-- > 0 ? TestBoard::Bytes{} : bytes;
    };
    ASSERT_TRUE(requester.exchange({&one.request, 1}));
    EXPECT_EQ(numbers.size(), one.fresh ? 3u : 1u) << int(one.request.type);
  }
}

TEST_F(Requesting, AReplyToAnyTransmissionOfStopCounts) {
  TestBoard::Bytes first;
  int sent = 0;
  board.to_board = [&](TestBoard::Bytes bytes) {
    if (++sent == 2) board.inject(first);
    return bytes;
  };
  board.to_host = [&](TestBoard::Bytes bytes) {
    if (first.empty()) first = bytes;
    return TestBoard::Bytes{};
  };
  const auto reply = requester.exchange_at_once(request_of(KZ_TYPE_stop));
  ASSERT_TRUE(reply) << reply.error().message;
  EXPECT_EQ(sent, 2);
  EXPECT_FALSE(reply->timed) << "it is not known to which transmission";
}

// Version 2 took a `stop` for a repetition of another program's: acknowledged, not executed.
TEST_F(Requesting, AStopThatLeavesMotorsOnIsSentAgain) {
  switch_on();
  int stops = 0;
  board.to_board = [&](TestBoard::Bytes bytes) {
    auto body = bodies_of(bytes).front();
    if (body[1] != KZ_TYPE_stop || ++stops > 1) return bytes;
    body = {body[0], KZ_TYPE_heartbeat, body[2], 0, 0};
    return framed(body);
  };
  board.to_host = [&](TestBoard::Bytes bytes) {
    auto body = bodies_of(bytes).front();
    if (body[1] == KZ_TYPE_heartbeat_reply) body[1] = KZ_TYPE_stop_reply;
    return framed(body);
  };
  const auto reply = requester.exchange_at_once(request_of(KZ_TYPE_stop));
  ASSERT_TRUE(reply) << reply.error().message;
  EXPECT_EQ(stops, 2);
  EXPECT_EQ(requester.statistics().timeouts, 0u);
  EXPECT_FALSE(board.motors_on());
}

// About 20 of so many random ones would (frame.h).
TEST(Requester, SendsNoFrameThatOneDamagedByteCouldSplit) {
  TestBoard board;
  int frames = 0, splits = 0;
  board.to_board = [&](TestBoard::Bytes wire) {
    ++frames;
    splits += kz_frame_splits(wire.data(), static_cast<u8>(wire.size()));
    return TestBoard::Bytes{};
  };
  Requester requester(board, board, {});
  std::mt19937 random(1);
  for (int i = 0; i < 30000; ++i) {
    kz_targets targets{};
    targets.mask = KZ_ALL_JOINTS;
    for (s16& angle : targets.angle) angle = static_cast<s16>(random());
    Request request;
    request.type = KZ_TYPE_targets;
    request.fields.length = kz_pack_targets(&targets, request.fields.bytes.data());
    ASSERT_TRUE(requester.send(request));
  }
  EXPECT_EQ(frames, 30000);
  EXPECT_EQ(splits, 0);
}

}  // namespace
}  // namespace kaz::host
