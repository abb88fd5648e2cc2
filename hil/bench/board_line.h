// The bench's connection to a board: sends typed requests, and collects telemetry frames with arrival times.
// SPDX-License-Identifier: Apache-2.0
//
// BoardLine uses the layer below host::Robot, because host::Robot would hide the errors that the bench
// counts. BoardLine does not recover a lost link.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/link/requester.h"
#include "host/robot/typed_request.h"

namespace kaz::hil {

// Called repeatedly with the name of the running measurement and the completed share of all measurements, 0
// to 1.
using BenchProgress = std::function<void(double share, const std::string& what)>;

// A telemetry frame that arrived.
struct Arrival {
  std::uint8_t type = 0;   // KZ_TYPE_telemetry_*
  std::uint32_t tick = 0;  // tick of the board
  Time at{};
  // Only in telemetry_health: duration of the last tick and of the longest tick, as fractions of the tick
  // period.
  double busy = 0, worst = 0;
};

class BoardLine {
 public:
  BoardLine(host::Link& link, host::Clock& clock, std::uint8_t address);

  // Finds the board, ends a telemetry stream that was left running, and runs `measure`. When this function
  // returns, also after an error, the motors and the stream are off. If the board shut down during `measure`
  // because requests were missing, the shutdown is cleared. `what` names the measurement in error messages:
  // "link" gives "the board was reset during the link measurement". Errors (environment): no board; a motor
  // of the board is already on; the board was reset during `measure`; errors of `measure`.
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

  // Makes the board send telemetry frames of `selection` every `period_ms`. A period of 0 ends the stream.
  // The result is the tick number from the board's reply.
  Result<std::uint32_t> stream(int period_ms, std::uint8_t selection);
  // Returns whether the board can stream telemetry. On a shared line, the board cannot stream.
  bool can_stream() const;
  // Reads until `t`. Also sends heartbeats to the board's link watchdog, which would otherwise end the
  // stream. Each heartbeat is sent right after a frame has arrived, so that the reply does not delay the
  // next frame.
  Result<void> listen_until(Time t);
  // Returns the frames that arrived since the last call.
  std::vector<Arrival> take_arrivals();

  // Checks the tick number in a reply. A large decrease of this number means that the board was reset.
  // Reordered frames cause only small decreases.
  void observe(const host::Reply& reply);

  // If `on`, holds all joints at their present angles; otherwise switches all joints off. The board refuses
  // to switch joints on while a shutdown is latched.
  Result<void> enable(bool on);
  // Switches the joints on, holds them in place, runs `load`, and switches the joints off. If the board's
  // link watchdog switches the joints off during a run, with_joints_on() starts another run. There are at
  // most four runs. A run counts only if the joints were on during the whole run. Error (environment): the
  // watchdog switched the joints off in each run.
  Result<void> with_joints_on(const std::function<Result<void>()>& load);

  host::Requester& requester() { return requester_; }
  host::Clock& clock() { return clock_; }
  const host::LinkStatistics& counts() const { return requester_.statistics(); }

 private:
  Result<void> begin();
  // Returns whether the board has shut down because requests were missing, and clears this shutdown.
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

// Loads the line with control cycles. Each cycle sends 18 targets and reads 18 angles. The targets are the
// present angles. While the joints are off, the board refuses the targets. The load stays the same, because a
// refusal is as long as an acknowledgment.
class CycleLoad {
 public:
  // `state` contains the present angles. `progress` gets the completed share of run(), 0 to 1.
  CycleLoad(BoardLine& line, const kz_state_reply& state, std::function<void(double)> progress);
  // Runs cycles until `end`, at `rate_hz` or, if `rate_hz` is 0, as fast as the link allows. Then waits for
  // the last reply.
  Result<void> run(double rate_hz, Time end);
  int cycles() const { return cycles_; }  // number of cycles whose angles arrived
  double rate_hz() const;                 // mean rate of completed cycles during run()

 private:
  struct Cycle {
    host::Requester::Ticket targets, state;
  };
  Result<void> run_fast(Time end);
  Result<void> run_paced(Time period, Time end);
  Result<void> send();
  // Receives the replies of the oldest cycle. Returns false if the replies have not arrived by `deadline`.
  Result<bool> receive(Time deadline);
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
