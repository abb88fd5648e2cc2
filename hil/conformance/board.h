// Interface of the test cases to the board under test: raw bytes, requests by name, and expected replies.
// SPDX-License-Identifier: Apache-2.0
//
// Every call throws Failed if the board does not behave as described; this exception ends the case. Every
// call throws Lost if the link is lost; this exception ends the whole run. The default value 0 of
// `at_most_ms` selects the usual timeout for a reply.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "hil/conformance/bench.h"
#include "hil/conformance/message.h"
#include "hil/report/check.h"
#include "host/link/link.h"
#include "shared/protocol/messages.h"

namespace kaz::hil {

constexpr int kNoDetail = 255;
constexpr int kAnyDetail = -1;

class Board {
 public:
  // `bench` may be null; all references must outlive this object. `slack` is the maximum delay of reading or
  // writing a byte. In lockstep, `clock` is the board's own clock, and `slack` is zero. `home` is the address
  // of the board.
  Board(host::Link& link, host::Clock& clock, Bench* bench, Time slack, std::uint64_t seed,
        std::uint8_t home = KZ_ADDRESS_DEFAULT);

  // begin() prepares a case. After begin(), the board has been reset and has no latched shutdown, and no
  // frame is in flight. end() switches the motors off.
  void begin(std::uint64_t case_seed);
  void end();

  Bench& bench() { return *bench_; }
  Time slack() const { return slack_; }
  bool exact() const { return slack_ == Time::zero(); }
  std::mt19937_64& random() { return random_; }
  std::uint8_t address = KZ_ADDRESS_DEFAULT;   // present address
  std::uint8_t home() const { return home_; }  // address at the beginning of each case
  // If `wanted` is not the board's home address, returns `wanted`. If `wanted` is the home address, returns
  // `wanted` - 1.
  std::uint8_t other_than_home(int wanted) const {
    return static_cast<std::uint8_t>(wanted == home_ ? wanted - 1 : wanted);
  }

  // ---- Bytes
  void write(const Bytes& bytes);
  std::optional<Frame> next(int at_most_ms);  // next frame of any type, also telemetry
  void silence(int ms);                       // fails if any frame other than telemetry comes
  void wait(int ms);                          // collects frames for next() and expect_frame()
  void forget_frames() { frames_.clear(); }   // drops frames that were not read
  // Returns the number of bytes outside frames plus the number of damaged frames.
  int wild_bytes() const { return deframer_.faults(); }
  Time now() const { return clock_.now(); }

  // ---- Frames
  std::uint8_t new_sequence() { return ++sequence_; }
  // Returns the frame of a request. If no sequence number is given, the frame has a new sequence number.
  Bytes request_bytes(std::string_view name, const Bytes& fields = {});
  Bytes request_bytes(std::string_view name, const Bytes& fields, std::uint8_t sequence) const;
  // Returns the next frame that is not telemetry. The frame's type, sequence number and address must match.
  Frame expect_frame(std::uint8_t type, std::uint8_t sequence, int at_most_ms = 0);
  // Sends a request with a new sequence number and returns the reply or refusal.
  Frame raw_request(std::uint8_t type, const Bytes& fields);
  // Sends the request `identify` and returns whether a frame arrives within 50 ms.
  bool answers();
  // Without a bench, searches all addresses for up to 2 s, and returns true if no board answers. With a
  // bench, returns false without a search, because the bench resets the board before the next case.
  bool gone();

  // ---- Requests by name

  // The method done() sends a request and returns the reply. The method take() returns the reply to an
  // earlier request. The methods refused(), refused_type() and take_refusal() return the refusal of the
  // board. The methods refused(), refused_type() and take_refusal() throw Failed if the board does not refuse
  // the request. They also throw Failed if the reason of the refusal differs from `reason`.
  Reply done(std::string_view name, const Bytes& fields = {}, int at_most_ms = 0);
  Reply take(std::string_view name, std::uint8_t sequence, int at_most_ms = 0);
  Reply refused(std::string_view name, const Bytes& fields, int reason, int detail = kAnyDetail);
  Reply refused_type(std::uint8_t type, const Bytes& fields, int reason, int detail = kAnyDetail);
  Reply take_refusal(std::uint8_t type, std::uint8_t sequence, int reason, int detail);

  Reply state() { return done("state"); }
  Reply health() { return done("health"); }
  Reply statistics() { return done("statistics"); }
  Reply joints(unsigned mask) { return done("joints", Put().u32(mask)); }
  long angle(int joint) { return state().number("angle", joint); }
  void enable(unsigned mask);
  void target(int joint, long angle, int duration_ms);
  void watchdog(int ten_ms, int reaction = 0);
  void stay_alive(int ms);  // waits, with a heartbeat every 30 ms
  void wait_until_still();  // polls until all ramps have ended; fails after 2 s
  void reset_by_command();  // resets and waits for the board
  void come_to_rest();      // waits until no joint moves, at most 3 s
  void expect_alive();      // checks that the next request is answered
  // Checks that all motors are off according to the board's status. With a bench, also checks that the drive
  // of each motor is 0.
  void expect_off();
  // Returns the telemetry frames of the next `ms` milliseconds and drops other frames. If `heartbeats`, sends
  // a heartbeat every 30 ms.
  std::vector<Frame> telemetry(int ms, bool heartbeats);

  // Returns the bytes exchanged in this case as text, at most the last 60 lines. Each line contains
  // consecutive bytes in one direction and the time of the first byte.
  const std::vector<std::string>& transcript() const { return transcript_; }

 private:
  void pump(Time deadline);
  void note(char direction, const Bytes& bytes);
  void come_back(int at_most_ms);
  int patience(int ms) const;

  host::Link& link_;
  host::Clock& clock_;
  Bench* bench_;
  Time slack_;
  std::uint64_t seed_;
  std::uint8_t home_;
  std::mt19937_64 random_;
  std::uint8_t sequence_ = 0;
  Deframer deframer_;
  std::deque<Frame> frames_;
  std::vector<std::string> transcript_;
  char last_direction_ = 0;
  mutable bool moved_ = false;  // a motor was switched on since the joints were last at rest
  Time started_{};
};

bool is_telemetry(const Frame& frame);

}  // namespace kaz::hil
