// The grammar, the judges and the search, each on inputs that are known to be right or wrong.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "hil/fuzz/conversation.h"
#include "hil/fuzz/requests.h"
#include "hil/fuzz/runner.h"
#include "hil/fuzz/search.h"
#include "hil/fuzz/tick_judge.h"
#include "host/link/board_testing.h"
#include "shared/base/files.hpp"
#include "shared/base/random.hpp"
#include "shared/board/table.h"

namespace kaz::hil::fuzz {
namespace {

Genome random_genome(std::uint64_t seed, std::size_t size) {
  Random random(mix64(seed));
  Genome genome(size);
  for (std::uint8_t& byte : genome) byte = static_cast<std::uint8_t>(random.below(256));
  return genome;
}

std::vector<std::uint8_t> frame(std::uint8_t address, std::uint8_t type, std::uint8_t sequence,
                                const std::vector<std::uint8_t>& fields = {}) {
  return framed(address, type, sequence, fields);
}
// A reply with its tick and status.
std::vector<std::uint8_t> reply(std::uint8_t type, std::uint8_t sequence, std::uint16_t status) {
  return frame(
      1, type, sequence,
      {0, 0, 0, 1, static_cast<std::uint8_t>(status >> 8), static_cast<std::uint8_t>(status)});
}

std::vector<std::uint8_t> enable_reply(std::uint8_t sequence, std::uint8_t mask) {
  return frame(1, KZ_TYPE_enable_reply, sequence,
               {0, 0, 0, 1, 0, KZ_STATUS_ENABLED, 0, 0, 0, mask});
}

TEST(Grammar, ReachesEveryRequestAndIsDeterminedByItsBytes) {
  std::set<int> types;
  std::set<Event::Kind> kinds;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Genome genome = random_genome(seed, 200);
    const auto events = events_of(genome, {});
    EXPECT_EQ(text_of(events), text_of(events_of(genome, {})));
    for (const Event& event : events) {
      kinds.insert(event.kind);
      kz_receiver receiver;
      kz_receiver_init(&receiver);
      for (const std::uint8_t byte : event.bytes) {
        if (kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME) types.insert(receiver.body[1]);
      }
    }
  }
  EXPECT_EQ(kinds.size(), 4u);
  for (const kz_message_info* message : request_types(true))
    EXPECT_TRUE(types.contains(message->code)) << message->name;
  EXPECT_TRUE(std::any_of(types.begin(), types.end(), [](int type) {
    return kz_message_find(static_cast<u8>(type)) == nullptr;
  })) << "a type that there is not";
}

TEST(Grammar, OmitsDisabledEvents) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    for (const Event& event :
         events_of(random_genome(seed, 300), {.faults = false, .line_faults = false}))
      EXPECT_NE(event.kind, Event::Kind::fault);
  }
  for (const kz_message_info* message : request_types(false))
    EXPECT_NE(message->code, KZ_TYPE_store_calibration);
}

// Also behind `clear` and `enable`, which take what the board remembers into another state.
TEST(Grammar, RepeatsEarlierFrames) {
  // A legal request: `stop`; then `clear` and `enable`; then the frame three before.
  const Genome genome{3, 10, 5, 1, 12, 0, 240, 2};
  std::vector<std::vector<std::uint8_t>> sent;
  for (const Event& event : events_of(genome, {}))
    if (event.kind == Event::Kind::send) sent.push_back(event.bytes);
  ASSERT_EQ(sent.size(), 4u) << text_of(events_of(genome, {}));
  EXPECT_EQ(sent[0][3], KZ_TYPE_stop);
  EXPECT_EQ(sent[2][3], KZ_TYPE_enable);
  EXPECT_EQ(sent[3], sent[0]);
}

TEST(Grammar, LegalRequestsAreInsideTheTablesBounds) {
  for (const kz_message_info* message : request_types(true)) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      const Genome genome = random_genome(seed, 100);
      Choices choices(genome);
      const auto made = make_request(*message, choices, true, 1, 0);
      const u8* fields = made.body.data() + KZ_HEADER_SIZE;
      const auto length = static_cast<u8>(made.body.size() - KZ_HEADER_SIZE);
      switch (message->code) {
#define KZ_MESSAGE(name, number, kind, words)                              \
  case number: {                                                           \
    kz_##name unpacked;                                                    \
    ASSERT_TRUE(kz_unpack_##name(&unpacked, fields, length)) << made.text; \
    EXPECT_EQ(kz_check_##name(&unpacked), KZ_IN_BOUNDS) << made.text;      \
    break;                                                                 \
  }
#include "shared/protocol/messages.def"
      }
    }
  }
}

TEST(Conversation, OneReplyToOneRequestIsRight) {
  Conversation judge;
  judge.sent(frame(1, KZ_TYPE_state, 7));
  judge.received(reply(KZ_TYPE_state_reply, 7, 0));
  EXPECT_FALSE(judge.violation());
  EXPECT_EQ(judge.replies_to(KZ_TYPE_state, 7), 1);
}

struct WrongReply {
  const char* what;
  std::vector<std::uint8_t> sent, received;
};

TEST(Conversation, WhatTheBoardMustNotSend) {
  auto damaged = reply(KZ_TYPE_state_reply, 7, 0);
  damaged[6] ^= 1;
  auto twice = reply(KZ_TYPE_stop_reply, 7, KZ_SHUTDOWN_STOP << 8);
  twice.insert(twice.end(), twice.begin(), twice.end());
  const WrongReply wrong[] = {
      {"answers no request", {}, reply(KZ_TYPE_state_reply, 7, 0)},
      {"another number", frame(1, KZ_TYPE_state, 6), reply(KZ_TYPE_state_reply, 7, 0)},
      {"another type", frame(1, KZ_TYPE_state, 7), reply(KZ_TYPE_health_reply, 7, 0)},
      {"to a broadcast", frame(15, KZ_TYPE_stop, 7),
       reply(KZ_TYPE_stop_reply, 7, KZ_SHUTDOWN_STOP << 8)},
      {"to another board's request", frame(2, KZ_TYPE_state, 7), reply(KZ_TYPE_state_reply, 7, 0)},
      {"twice", frame(1, KZ_TYPE_stop, 7), twice},
      {"damaged", frame(1, KZ_TYPE_state, 7), damaged},
      {"motors on after stop", frame(1, KZ_TYPE_stop, 7),
       reply(KZ_TYPE_stop_reply, 7, KZ_STATUS_ENABLED)},
      {"joints on after enable of none", frame(1, KZ_TYPE_enable, 7, {0, 0, 0, 0}),
       enable_reply(7, 2)},
      {"a joint on outside the mask", frame(1, KZ_TYPE_enable, 7, {0, 0, 0, 1}),
       enable_reply(7, 3)},
      {"on in spite of a shutdown", frame(1, KZ_TYPE_state, 7),
       reply(KZ_TYPE_state_reply, 7, KZ_SHUTDOWN_POT << 8 | KZ_STATUS_ENABLED)},
      {"telemetry without a request", {}, reply(KZ_TYPE_telemetry_state, 0, 0)},
      {"a request", {}, reply(KZ_TYPE_state, 7, 0)},
  };
  for (const WrongReply& one : wrong) {
    Conversation judge;
    judge.sent(one.sent);
    EXPECT_FALSE(judge.violation());
    judge.received(one.received);
    EXPECT_TRUE(judge.violation()) << one.what;
  }
}

TEST(Conversation, ALaterRequestMaySwitchOnBeforeTheReplyToStop) {
  Conversation judge;
  judge.sent(frame(1, KZ_TYPE_enable, 6, {0, 0, 0, 1}));
  judge.sent(frame(1, KZ_TYPE_stop, 7));
  judge.sent(frame(15, KZ_TYPE_clear, 8));
  judge.sent(frame(15, KZ_TYPE_enable, 9, {0, 0, 0, 1}));
  judge.received(reply(KZ_TYPE_stop_reply, 7, KZ_STATUS_ENABLED));
  EXPECT_FALSE(judge.violation());
  judge.sent(frame(1, KZ_TYPE_stop, 7));  // after them
  judge.received(reply(KZ_TYPE_stop_reply, 7, KZ_STATUS_ENABLED));
  EXPECT_TRUE(judge.violation());
}

// A servo that stands still with all joints on in the middle of their range.
struct Servo {
  kz_servo state{};
  kz_tick_input input{};
  kz_tick_output output{};
  Servo() {
    state.enabled = KZ_ALL_JOINTS;
    input.tx_room = KZ_TX_BUFFER;
    output.p4 = KZ_P4_ENABLE;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      kz_joint& joint = state.joint[j];
      joint.on = 1;
      joint.lower = kz_board_joints[j].lower;
      joint.upper = kz_board_joints[j].upper;
      joint.ramp_limit = 60;
    }
  }
};

// What the judge says to a tick that `spoil` has changed, after one that was right.
std::optional<std::string> judged(
    const std::function<void(Servo&)>& spoil,
    const std::function<void(Servo&)>& before = [](Servo&) {}) {
  Servo servo;
  before(servo);
  TickJudge judge;
  judge.tick(servo.input, servo.state, servo.output);
  EXPECT_FALSE(judge.violation()) << *judge.violation();
  spoil(servo);
  for (int i = 0; i < 5; ++i) judge.tick(servo.input, servo.state, servo.output);
  return judge.violation();
}

TEST(TickJudge, AllowsWhatIsRight) {
  EXPECT_FALSE(judged([](Servo&) {}));
  EXPECT_FALSE(judged([](Servo& servo) { servo.state.joint[0].command = 60; }));
  EXPECT_FALSE(judged([](Servo& servo) { servo.output.pw[0] = 255; }));
}

TEST(TickJudge, FindsWhatMustNotBe) {
  EXPECT_TRUE(judged([](Servo& servo) { servo.state.joint[0].command = 61; }));
  EXPECT_TRUE(judged(
      [](Servo& servo) {
        servo.state.joint[0].command = -5;  // from 0, below limits that stood before
      },
      [](Servo& servo) { servo.state.joint[0].lower = 10; }));
  EXPECT_TRUE(judged([](Servo& servo) { servo.state.joint[3].upper = 30000; }));
  EXPECT_TRUE(judged([](Servo& servo) { servo.state.shutdown = KZ_SHUTDOWN_STOP; }));
  EXPECT_TRUE(judged([](Servo& servo) { servo.output.tx_count = 17; }));
  EXPECT_TRUE(judged([](Servo& servo) { servo.state.enabled = 0; }));
  EXPECT_TRUE(judged([](Servo& servo) {
    servo.state.enabled &= ~1u;
    servo.state.joint[0].on = 0;
    servo.output.pw[0] = 1;
  }));
  EXPECT_TRUE(judged([](Servo& servo) {  // neck_pan forward at its upper limit, in a raw drive
    servo.state.enabled = 0;
    for (kz_joint& joint : servo.state.joint) joint.on = 0;
    servo.state.raw_ms = 5;
    servo.state.joint[0].angle = servo.state.joint[0].upper;
    servo.output.pw[0] = 1;
    servo.output.p3 |= 1;
  }));
}

// `wire` in ticks of at most 16 bytes, to a servo that has all joints on and changes nothing.
std::optional<std::string> judged_bytes(const std::vector<std::uint8_t>& wire, unsigned refusals) {
  Servo servo;
  servo.state.address = KZ_ADDRESS_DEFAULT;
  TickJudge judge;
  judge.tick(servo.input, servo.state, servo.output);
  servo.state.refusals = static_cast<u16>(refusals);
  for (std::size_t at = 0; at < wire.size(); at += servo.input.rx_count) {
    servo.input.rx_count = static_cast<u8>(std::min<std::size_t>(wire.size() - at, KZ_RX_PER_TICK));
    std::copy_n(wire.begin() + static_cast<std::ptrdiff_t>(at), servo.input.rx_count,
                servo.input.rx);
    judge.tick(servo.input, servo.state, servo.output);
  }
  return judge.violation();
}

TEST(TickJudge, FindsMotorsThatARequestHasNotSwitchedOff) {
  EXPECT_TRUE(judged_bytes(frame(1, KZ_TYPE_stop, 7), 0));
  EXPECT_TRUE(judged_bytes(frame(15, KZ_TYPE_stop, 7), 0));
  EXPECT_TRUE(judged_bytes(frame(15, KZ_TYPE_enable, 7, {0, 0, 0, 0}), 0));
  EXPECT_FALSE(judged_bytes(frame(1, KZ_TYPE_enable, 7, {0, 0, 0, 0}), 1)) << "refused";
  EXPECT_FALSE(judged_bytes(frame(1, KZ_TYPE_enable, 7, {0, 0, 0, 1}), 0));
  EXPECT_FALSE(judged_bytes(frame(2, KZ_TYPE_stop, 7), 0));
  auto damaged = frame(1, KZ_TYPE_stop, 7);
  damaged[4] ^= 1;
  EXPECT_FALSE(judged_bytes(damaged, 0));
}

// A "board" that goes wrong on two neighbouring bytes.
Result<CaseVerdict> picky(const Genome& genome) {
  CaseVerdict verdict;
  for (std::size_t i = 0; i + 1 < genome.size(); ++i) {
    verdict.features.insert(genome[i] / 16u);
    if (genome[i] == 0x42 && genome[i + 1] >= 0xC0) verdict.violation = "42";
  }
  return verdict;
}

TEST(Search, FindsAndShortensAndRepeatsItself) {
  const auto first = [] {
    Search search(3);
    for (int i = 0; i < 5000; ++i) {
      const Genome genome = search.next();
      const auto verdict = picky(genome).value();
      if (verdict.violation) return genome;
      search.learn(genome, verdict);
    }
    return Genome{};
  };
  const Genome found = first();
  ASSERT_GT(found.size(), 2u);
  EXPECT_EQ(found, first());
  const Genome shorter = shortened(found, picky, 1000);
  EXPECT_EQ(shorter.size(), 2u);
  EXPECT_TRUE(picky(shorter)->violation);
}

TEST(Search, OnlyNewFeaturesJoinTheCorpus) {
  Search search(1);
  CaseVerdict verdict;
  verdict.features = {1, 2};
  EXPECT_TRUE(search.learn({1}, verdict));
  EXPECT_FALSE(search.learn({2}, verdict));
  verdict.features.insert(3);
  EXPECT_TRUE(search.learn({3}, verdict));
  EXPECT_EQ(search.corpus().size(), 2u);
}

// Another run of the same seed has written its case there.
TEST(Search, ACaseInTheCorpusIsNotReplaced) {
  const std::string folder = make_temporary_folder("kaz-corpus-").value();
  ASSERT_TRUE(save_genome(folder + "/1-7", {1}));
  ASSERT_TRUE(save_genome(folder + "/1-7", {2}));
  EXPECT_EQ(load_corpus(folder).value(), (std::vector<Genome>{{1}, {2}}));
  std::filesystem::remove_all(folder);
}

TEST(Search, ACaseThatCannotBeWrittenIsNamed) {
  const auto saved = save_genome("/proc/case", {1});
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().fault, Fault::environment);
  EXPECT_NE(saved.error().message.find("/proc/case"), std::string::npos);
}

// Half a second of bytes is still on the line when the request is written.
TEST(Runner, WaitsForABusyLineBeforeALonelyRequest) {
  host::TestBoard board;
  Event noise, request;
  noise.kind = Event::Kind::send;
  noise.bytes.assign(6000, 0x55);
  request.kind = Event::Kind::query;
  request.bytes = frame(KZ_ADDRESS_DEFAULT, KZ_TYPE_identify, 7);
  request.text = "identify";
  const Event events[] = {noise, request};
  const auto verdict = run_case(board, board, events, {});
  ASSERT_TRUE(verdict) << verdict.error().message;
  EXPECT_FALSE(verdict->violation) << *verdict->violation;
}

}  // namespace
}  // namespace kaz::hil::fuzz
