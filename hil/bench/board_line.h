// A board as the bench talks to it: typed requests, and telemetry frames with their arrival times.
// SPDX-License-Identifier: Apache-2.0
//
// Below host::Robot, which makes good what the bench is to count: no link is sought again here.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/link/requester.h"
#include "host/robot/typed_request.h"

namespace kaz::hil {

// Called now and then with the measurement in progress and the share of all that is done.
using BenchProgress = std::function<void(double share, const std::string& what)>;

// A frame of telemetry that came.
struct Arrival {
  std::uint8_t type = 0;   // KZ_TYPE_telemetry_*
  std::uint32_t tick = 0;  // of the board
  Time at{};
  double busy = 0, worst = 0;  // telemetry_health: shares of a tick
};

class BoardLine {
 public:
  BoardLine(host::Link& link, host::Clock& clock, std::uint8_t address);

  // Finds the board, ends a stream left running, measures, and leaves motors off, no stream, and no shutdown
  // for want of requests that was not there before, also after errors. `what`: "its link was", for the error.
  // Errors (environment): there is no board; its motors are on, which the measurement would switch off; it
  // was reset meanwhile; those of `measure`.
  Result<void> measure(const std::string& what, const std::function<Result<void>()>& measure);

  template <class Message, class Answer>
  Result<Answer> query(std::uint8_t type, const Message& message, u8 (*pack)(const Message*, u8*),
                       u8 (*unpack)(Answer*, const u8*, u8)) {
    const host::Request request = host::make_request(type, message, pack);
    const auto replies = requester_.exchange({&request, 1});
    if (!replies) return tl::unexpected(replies.error());
    observe(replies->front());
    return host::read_reply(replies->front(), unpack);
  }
  Result<kz_statistics_reply> statistics();
  Result<kz_state_reply> state();

  // Frames of the selection every `period_ms`, or none. The tick from which on.
  Result<std::uint32_t> stream(int period_ms, std::uint8_t selection);
  // Whether a stream is to be had at all: not on a shared line.
  bool can_stream() const;
  // Reads until then, and keeps the board's link watchdog content, which would end the stream; each
  // time just after a frame, so that no reply delays the next frame.
  Result<void> listen_until(Time t);
  // Those that came since the last call.
  std::vector<Arrival> take_arrivals();

  // Every reply contains the tick, which must not decrease.
  void observe(const host::Reply& reply);

  // Holds all joints where they are; refused while a shutdown is latched.
  Result<void> enable(bool on);
  // Runs `load` with the joints on, held, and off again; again where the board has switched them off because
  // no request came for its watchdog's time, as when this program was stopped: the load was not the one that
  // was meant. Error (environment): it did so each time.
  Result<void> with_joints_on(const std::function<Result<void>()>& load);

  host::Requester& requester() { return requester_; }
  host::Clock& clock() { return clock_; }
  const host::LinkStatistics& counts() const { return requester_.statistics(); }

 private:
  Result<void> begin();
  // Whether the board has shut down for want of requests; forgotten then.
  Result<bool> clear_link_lost();
  void end() noexcept;
  void observe_tick(std::uint32_t tick);
  void take(std::uint8_t type, std::span<const std::uint8_t> fields, Time at);

  host::Link& link_;
  host::Clock& clock_;
  host::Requester requester_;
  kz_identify_reply identity_{};
  std::vector<Arrival> arrivals_;
  std::uint32_t last_tick_ = 0;
  bool on_ = false, streaming_ = false, was_reset_ = false;
};

// Control cycles: 18 targets out, 18 angles back. With the joints off the board refuses the targets,
// which takes as many bytes; with the joints on they are where the joints stood.
class CycleLoad {
 public:
  // `state`: where the joints stand. `progress` gets the share of run() that is over, 0 to 1.
  CycleLoad(BoardLine& line, const kz_state_reply& state, std::function<void(double)> progress);
  // At `rate_hz`, or as fast as the link takes them (0), until `end`; then waits for the last reply.
  Result<void> run(double rate_hz, Time end);
  int cycles() const { return cycles_; }  // whose angles came
  double rate_hz() const;                 // of those, over the time of run()

 private:
  struct Cycle {
    host::Requester::Ticket targets, state;
  };
  Result<void> run_fast(Time end);
  Result<void> run_paced(Time period, Time end);
  Result<void> send();
  Result<bool> receive(Time deadline);  // the oldest cycle
  void report_progress();

  BoardLine& line_;
  host::Request targets_, state_;
  std::vector<Cycle> under_way_;
  std::function<void(double)> progress_;
  Time start_ = Time::zero(), end_ = Time::zero();
  int cycles_ = 0;
  double seconds_ = 0;
};

}  // namespace kaz::hil
