// CAN logs: their lines, their messages, and requests repeated on a virtual board.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/can_answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "host/link/can_link.h"
#include "sim/runtime/simulation/world_testing.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::tools {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Kind = CanLogFrame::Kind;
using std::chrono::milliseconds;

constexpr Time kTestLead = milliseconds(300);

// Lines of a log, as candump writes them: each message in ISO-TP frames.
class CanLogWriter {
 public:
  // `time`: since the start of the log.
  void add(Time time, std::uint32_t id, const Bytes& message) {
    time_ = time;
    if (message.size() <= 7)
      return frame(id, Bytes{static_cast<std::uint8_t>(message.size())}, message);
    frame(id,
          {static_cast<std::uint8_t>(0x10 | message.size() >> 8),
           static_cast<std::uint8_t>(message.size())},
          Bytes(message.begin(), message.begin() + 6));
    frame(id ^ 0x10, {0x30, 0, 0}, {});  // flow control
    std::uint8_t sequence = 1;
    for (std::size_t at = 6; at < message.size(); at += 7)
      frame(id, {static_cast<std::uint8_t>(0x20 | (sequence++ & 15))},
            Bytes(message.begin() + static_cast<std::ptrdiff_t>(at),
                  message.begin() + static_cast<std::ptrdiff_t>(std::min(at + 7, message.size()))));
  }
  const std::string& text() const { return text_; }

 private:
  void frame(std::uint32_t id, Bytes data, const Bytes& more) {
    data.insert(data.end(), more.begin(), more.end());
    char head[64];
    std::snprintf(head, sizeof head, "(1436509052.%06lld) can0 %03X#",
                  static_cast<long long>(time_ / std::chrono::microseconds(1)),
                  static_cast<unsigned>(id));
    text_ += head;
    for (const std::uint8_t byte : data) {
      char digits[4];
      std::snprintf(digits, sizeof digits, "%02X", static_cast<unsigned>(byte));
      text_ += digits;
    }
    text_ += '\n';
  }
  Time time_{};
  std::string text_;
};

// The message of a frame: its bytes without the zeros.
Bytes can_message(const Bytes& body) {
  Bytes wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return {wire.begin() + 1, wire.end() - 1};
}

// Requests that switch a joint on, change its gains and query it; the last one is refused.
const std::vector<Bytes> kRequests = {{1, KZ_TYPE_identify, 10},
                                      {1, KZ_TYPE_enable, 11, 0, 0, 0, 1},
                                      {1, KZ_TYPE_gains, 12, 0, 0, 0, 1, 8, 0, 1, 0, 0, 50, 3},
                                      {1, KZ_TYPE_settings, 13, 0},
                                      {1, KZ_TYPE_state, 14},
                                      {1, KZ_TYPE_reset, 15, 0x4B, 0x5A}};

struct Run {
  std::unique_ptr<sim::Simulation> simulation = sim::test_simulation();
  lockstep::LockstepClock clock{*simulation};
  lockstep::LockstepLink link{*simulation};
};

CanMessages messages_of(const std::string& text) {
  auto messages = can_messages("bus.log", parse_can_log("bus.log", text).value());
  EXPECT_TRUE(messages) << messages.error().message;
  return messages ? *messages : CanMessages();
}

// A log of the requests alone, or with the answers of a board.
std::string log_of(const std::vector<CanAnswer>& answers) {
  struct Entry {
    Time time{};
    std::uint32_t id = 0;
    Bytes body;
  };
  std::vector<Entry> entries;
  for (std::size_t k = 0; k < kRequests.size(); ++k)
    entries.push_back(
        {milliseconds(20) * static_cast<int>(k), host::kCanRequests + 1, kRequests[k]});
  for (const CanAnswer& answer : answers) entries.push_back({answer.time, answer.id, answer.body});
  std::ranges::stable_sort(entries, {}, &Entry::time);
  CanLogWriter log;
  for (const Entry& entry : entries) log.add(entry.time, entry.id, can_message(entry.body));
  return log.text();
}

std::string log_of_a_run() {
  Run run;
  const auto answers =
      repeat_requests(messages_of(log_of({})), run.link, run.clock, kTestLead).value();
  return log_of(answers);
}

CanComparison replayed(const std::string& log) {
  Run run;
  const CanMessages messages = messages_of(log);
  const auto now = repeat_requests(messages, run.link, run.clock, kTestLead);
  EXPECT_TRUE(now) << now.error().message;
  return compare_answers(answers_in(messages), *now);
}

TEST(CanLog, ReadsEveryFormOfAFrame) {
  const auto frames = parse_can_log("bus.log",
                                    "(1436509052.249713) vcan0 044#2A366C2BBA\n"
                                    "(1436509052.249813) vcan0 1F334455#11.22.33 T\r\n"
                                    "(1436509052.250000) vcan0 123#R5\n"
                                    "\n"
                                    "(1436509052.249000) vcan1 123##1AABB\n"
                                    "(1436509053.000000) vcan0 20000004#0004000000000000\n"
                                    "(1436509053.5) vcan0 7FF#0102030405060708_9 R\n"
                                    "(1436509053.6) vcan0 7FF#");
  ASSERT_TRUE(frames) << frames.error().message;
  ASSERT_EQ(frames->size(), 7u);
  const auto& f = *frames;
  EXPECT_EQ(f[0].data, (Bytes{0x2A, 0x36, 0x6C, 0x2B, 0xBA}));
  EXPECT_EQ(f[1].id, 0x1F334455u);
  EXPECT_TRUE(f[1].extended);
  EXPECT_EQ(f[1].data, (Bytes{0x11, 0x22, 0x33}));
  EXPECT_EQ(f[1].time, std::chrono::microseconds(100));
  EXPECT_EQ(f[2].kind, Kind::remote);
  EXPECT_EQ(f[3].kind, Kind::fd);
  EXPECT_EQ(f[3].data, (Bytes{0xAA, 0xBB}));
  EXPECT_EQ(f[3].interface, "vcan1");
  EXPECT_EQ(f[3].line, 5u);
  EXPECT_EQ(f[3].time, f[2].time) << "times never decrease";
  EXPECT_EQ(f[4].kind, Kind::error);
  EXPECT_EQ(f[4].id, 4u);
  EXPECT_EQ(f[5].data.size(), 8u);
  EXPECT_TRUE(f[6].data.empty());
}

TEST(CanLog, NamesTheLineThatIsNoFrame) {
  for (const char* bad :
       {"can0 123 [2] 11 22", "(x) can0 123#11", "(1.) can0 123#11", "(1.0)can0 123#11",
        "(1.0) can0 12#11", "(1.0) can0 800#11", "(1.0) can0 123#1",
        "(1.0) can0 123#1122334455667788AA", "(1.0) can0 12311", "(1.0) can0 123#11 X",
        "(1.0) can0 123##", "(1.0) can0 FFFFFFFF1#", "(100000.0) can0 123#11"}) {
    const auto frames = parse_can_log("bus.log", std::string("(0.5) can0 123#11\n") + bad + "\n");
    ASSERT_FALSE(frames) << bad;
    EXPECT_EQ(frames.error().fault, Fault::usage);
    EXPECT_EQ(frames.error().message.find("bus.log:2: "), 0u) << frames.error().message;
  }
  EXPECT_FALSE(parse_can_log("bus.log", "\n\n"));
}

TEST(CanLog, AssemblesIsoTpAndCountsBrokenMessages) {
  const CanMessages log = messages_of(
      "(1.000) can0 6A1#0301020300000000\n"  // padded
      "(1.001) can0 6B1#1009010203040506\n"  // 9 bytes
      "(1.002) can0 6A1#300000\n"
      "(1.003) can0 6B1#21070809\n"
      "(1.004) can0 6B1#1009010203040506\n"
      "(1.005) can0 6B1#22070809\n"  // the wrong sequence number
      "(1.006) can0 123#11\n"
      "(1.007) can0 6AF#0207\n"                // too short
      "(1.008) can0 6B2#1009010203040506\n");  // the log ends
  ASSERT_EQ(log.messages.size(), 2u);
  EXPECT_TRUE(log.messages[0].from_host);
  EXPECT_EQ(log.messages[0].bytes, (Bytes{1, 2, 3}));
  EXPECT_FALSE(log.messages[1].from_host);
  EXPECT_EQ(log.messages[1].bytes, (Bytes{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(log.messages[1].line, 4u);
  EXPECT_EQ(log.messages[1].time, milliseconds(3));
  EXPECT_EQ(log.incomplete, 3u);
  EXPECT_EQ(log.other_frames, 1u);
}

TEST(CanLog, WithoutARequestListsTheIdentifiers) {
  const auto frames = parse_can_log("bus.log", "(1.0) can0 123#11\n(1.0) can0 6B1#0111\n").value();
  const auto none = can_messages("bus.log", frames);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("0x123, 0x6B1"), std::string::npos) << none.error().message;
  const auto two = parse_can_log("bus.log", "(1.0) can0 6A1#0111\n(1.0) can1 6A1#0111\n").value();
  const auto both = can_messages("bus.log", two);
  ASSERT_FALSE(both);
  EXPECT_NE(both.error().message.find("can0 and can1"), std::string::npos) << both.error().message;
}

TEST(CanReplay, AnUnchangedBoardAnswersAsInTheLog) {
  const CanComparison same = replayed(log_of_a_run());
  EXPECT_EQ(same.answers, kRequests.size());
  EXPECT_TRUE(same.differences.empty()) << same.differences.front().what;
  ASSERT_TRUE(same.measured.contains("angle"));
  EXPECT_EQ(same.measured.at("angle").largest, 0) << "the same board with the same noise";
}

TEST(CanReplay, NamesAnswersThatDifferByLineTimeAndBytes) {
  std::vector<CanAnswer> recorded = answers_in(messages_of(log_of_a_run()));
  ASSERT_EQ(recorded.size(), kRequests.size());
  recorded[3].body[KZ_HEADER_SIZE + 4 + 2 + 1 + 1] ^= 1;  // settings_reply: low byte of kp
  recorded[4].body[KZ_HEADER_SIZE + 4 + 2 + 2 + 1] ^= 1;  // state_reply: a measured angle
  const CanComparison other = replayed(log_of(recorded));
  ASSERT_EQ(other.differences.size(), 1u);
  const CanDifference& kp = other.differences.front();
  EXPECT_EQ(kp.id, 0x6B1u);
  EXPECT_NE(kp.what.find("settings_reply #13: kp is "), std::string::npos) << kp.what;
  EXPECT_GT(kp.line, 1u);
  EXPECT_GE(kp.time, milliseconds(60));
  EXPECT_LT(kp.time, milliseconds(80));
  EXPECT_EQ(kp.recorded, recorded[3].body);
  EXPECT_NE(kp.now, kp.recorded);
  EXPECT_EQ(other.measured.at("angle").largest, 1);
}

TEST(CanReplay, NamesMissingAndAdditionalAnswers) {
  std::vector<CanAnswer> recorded = answers_in(messages_of(log_of_a_run()));
  ASSERT_EQ(recorded.size(), kRequests.size());
  recorded[1].body[KZ_BODY_SEQUENCE] = 99;
  const CanComparison other = replayed(log_of(recorded));
  EXPECT_EQ(other.answers, kRequests.size() - 1);
  ASSERT_EQ(other.differences.size(), 2u);
  EXPECT_EQ(other.differences[0].what, "enable_reply #99: no answer now");
  EXPECT_TRUE(other.differences[0].now.empty());
  EXPECT_EQ(other.differences[1].what, "enable_reply #11: no such answer in the log");
  EXPECT_EQ(other.differences[1].line, 0u);
}

TEST(CanReplay, ARefusalInsteadOfAReplyIsADifference) {
  std::vector<CanAnswer> recorded = answers_in(messages_of(log_of_a_run()));
  ASSERT_EQ(recorded.back().body[KZ_BODY_TYPE], KZ_TYPE_refused);
  recorded.back().body[KZ_BODY_TYPE] = KZ_TYPE_reset_reply;
  recorded.back().body.resize(KZ_HEADER_SIZE + KZ_SIZE_reset_reply);
  const CanComparison other = replayed(log_of(recorded));
  ASSERT_EQ(other.differences.size(), 1u);
  EXPECT_NE(other.differences[0].what.find("the answer now is refused #15"), std::string::npos)
      << other.differences[0].what;
}

}  // namespace
}  // namespace kaz::tools
