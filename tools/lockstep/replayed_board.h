// A board and eyes that are a recording: the host runs against them as it did against the simulation.
// SPDX-License-Identifier: Apache-2.0
//
// Time goes on in step(), by one millisecond, as in the simulation. Bytes that the board sent come at
// their recorded times, pictures at theirs; what the host sends is compared, byte by byte and state by
// state, with what reached the board then. Faults of the line happen to the bytes again, by the same
// seed.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "host/link/link.h"
#include "shared/base/result.hpp"
#include "sim/runtime/simulation/serial_line.h"
#include "tools/lockstep/recorded_run.h"
#include "vision/image/frame.h"

namespace kaz::lockstep {

// Where host and recording part.
struct HostDifference {
  Time time{};
  std::string where;          // "byte 1234 to the board", "the behaviour's record", "the end"
  std::string recorded, now;  // in words
};

class ReplayedBoard {
 public:
  // The run must outlive what stands on it.
  explicit ReplayedBoard(const RecordedRun& run);
  ReplayedBoard(const ReplayedBoard&) = delete;
  ReplayedBoard& operator=(const ReplayedBoard&) = delete;

  // One millisecond. Fails (failed), and from then on, when the host has sent something else than in
  // the recording, and when the recording is at its end.
  Result<void> step();
  Time time() const;
  const std::optional<Error>& error() const { return error_; }
  const RecordedRun& run() const { return run_; }

  void write(std::span<const std::uint8_t> bytes) { line_.write(bytes, now_); }
  std::size_t read(std::span<std::uint8_t> bytes) { return line_.read(bytes, now_); }
  // The next pair that has reached the host by now. Errors: a picture cannot be decoded; there are
  // none.
  Result<std::optional<vision::StereoPair>> next_pair();
  // What the behaviour enters into its record: compared as well.
  void think(const std::string& json);

  // To be called when the host is done: something that was sent and recorded may be missing.
  void finish();
  // In what was sent to the board, the first.
  const std::optional<HostDifference>& difference() const { return difference_; }
  // In the behaviour's record, the first; it may come before what is sent because of it.
  const std::optional<HostDifference>& other_thought() const { return other_thought_; }

 private:
  void compare(std::span<const sim::SerialByte> arrived, sim::States end);
  void differ(std::span<const sim::SerialByte> arrived, std::size_t at);
  Result<void> stop(const std::string& why);
  tl::unexpected<Error> stop_for(Fault fault, const std::string& why);

  const RecordedRun& run_;
  sim::SerialLine line_;
  sim::States now_ = 0;
  std::size_t compared_ = 0, given_ = 0, exposed_ = 0, thought_ = 0;  // of the run, so far
  std::vector<std::uint8_t> sent_;                                    // that reached the board
  std::deque<const RecordedRun::Pair*> arriving_;
  std::optional<HostDifference> difference_, other_thought_;
  std::optional<Error> error_;
};

class ReplayClock final : public host::Clock {
 public:
  explicit ReplayClock(ReplayedBoard& board) : board_(board) {}
  Time now() const override { return board_.time(); }
  Result<void> sleep_until(Time t) override;

 private:
  ReplayedBoard& board_;
};

class ReplayLink final : public host::Link {
 public:
  explicit ReplayLink(ReplayedBoard& board) : board_(board) {}
  std::string name() const override { return "recording"; }
  Time byte_time() const override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;

 private:
  ReplayedBoard& board_;
};

class ReplayCamera final : public vision::Camera {
 public:
  explicit ReplayCamera(ReplayedBoard& board) : board_(board) {}
  const vision::CameraModel& model() const override { return board_.run().camera; }
  Result<std::optional<vision::StereoPair>> poll() override;

 private:
  ReplayedBoard& board_;
};

// The byte at `offset` of what a host sent, with the message that contains it: "0x3a in `enable` #12
// mask=0x3, frame 00 05 01 ...".
std::string byte_in_words(std::span<const std::uint8_t> sent, std::size_t offset);

}  // namespace kaz::lockstep
