// The board under test, as the cases talk to it: raw bytes, requests by name, what must come back.
// SPDX-License-Identifier: Apache-2.0
//
// Every call fails the case (Failed) when the board does otherwise than it describes, and ends the whole
// run (Lost) when the link is gone.
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
  // `bench` may be null. `slack`: how late a byte may be read or written, for clocks that are not
  // the board's own; zero in lockstep.
  Board(host::Link& link, host::Clock& clock, Bench* bench, Time slack, std::uint64_t seed,
        std::uint8_t home = KZ_ADDRESS_DEFAULT);

  // Before a case: reset, nothing latched, no frame in flight. After it: motors off.
  void begin(std::uint64_t case_seed);
  void end();

  Bench& bench() { return *bench_; }
  Time slack() const { return slack_; }
  bool exact() const { return slack_ == Time::zero(); }
  std::mt19937_64& random() { return random_; }
  std::uint8_t address = KZ_ADDRESS_DEFAULT;   // present
  std::uint8_t home() const { return home_; }  // at the beginning of each case
  // `wanted` as the address of somebody else: another one if the board is at home there.
  std::uint8_t other_than_home(int wanted) const {
    return static_cast<std::uint8_t>(wanted == home_ ? wanted - 1 : wanted);
  }

  // ---- Bytes
  void write(const Bytes& bytes);
  std::optional<Frame> next(int at_most_ms);  // telemetry too
  void silence(int ms);                       // fails if a frame comes
  void wait(int ms);                          // what comes meanwhile can be read afterwards
  void forget_frames() { frames_.clear(); }   // that came and were not read
  int wild_bytes() const { return deframer_.faults(); }
  Time now() const { return clock_.now(); }

  // ---- Frames
  std::uint8_t new_sequence() { return ++sequence_; }
  Bytes request_bytes(std::string_view name, const Bytes& fields = {});  // with a new number
  Bytes request_bytes(std::string_view name, const Bytes& fields, std::uint8_t sequence) const;
  // The next frame that is no telemetry; its type, number and address must be these.
  Frame expect_frame(std::uint8_t type, std::uint8_t sequence, int at_most_ms = 0);
  Frame raw_request(std::uint8_t type, const Bytes& fields);  // reply or refusal, with a new number
  bool answers();                                             // to identify, in 50 ms
  // Whether nobody answers at any address, also not one who is still starting; false at a bench, which
  // resets the board for the next case.
  bool gone();

  // ---- Requests by name
  Reply done(std::string_view name, const Bytes& fields = {}, int at_most_ms = 0);
  Reply take(std::string_view name, std::uint8_t sequence, int at_most_ms = 0);  // reply to `name`
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
  void stay_alive(int ms);  // waits, with a heartbeat each 30 ms
  void wait_until_still();  // until no ramp is under way, with heartbeats
  void reset_by_command();  // and waits for the board
  void come_to_rest();      // waits until no joint moves, 3 s at most
  void expect_alive();      // the next request is answered
  void expect_off();        // no motor is on: by status, and by the pins where there is a bench
  std::vector<Frame> telemetry(int ms, bool heartbeats);  // what came in this time

  // The bytes exchanged in this case, one line per direction and time.
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
