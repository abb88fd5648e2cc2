// Replays a recording as a board with eyes. The host uses this board in the same way as the simulation.
// SPDX-License-Identifier: Apache-2.0
//
// step() advances time by one millisecond, like the simulation. Pictures and the board's bytes arrive at the
// host at their recorded times. Every byte from the host is compared with the recorded byte. The arrival time
// of the byte at the board must be equal to the recorded arrival time. Arrival times are counted in periods
// of the board's crystal. Line faults change the bytes in the same way as in the recorded run, because the
// recorded seed is used. Single-threaded.
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

// First difference between the host and the recording.
struct HostDifference {
  Time time{};
  std::string where;  // position, such as "byte 1234 to the board" or "the end"
  // `recorded` describes the byte or entry in the recording. `now` describes the byte or entry in the present
  // run.
  std::string recorded, now;
};

class ReplayedBoard {
 public:
  // `run` must outlive the board, and the board must outlive its link, clock and camera.
  explicit ReplayedBoard(const RecordedRun& run);
  ReplayedBoard(const ReplayedBoard&) = delete;
  ReplayedBoard& operator=(const ReplayedBoard&) = delete;

  // Advances by one millisecond. Returns Fault::failed at the end of the recording, or if the host's bytes
  // differ from the recorded bytes. Later calls return the same error.
  Result<void> step();
  Time time() const;
  const std::optional<Error>& error() const { return error_; }
  const RecordedRun& run() const { return run_; }

  void write(std::span<const std::uint8_t> bytes) { line_.write(bytes, now_); }
  std::size_t read(std::span<std::uint8_t> bytes) { return line_.read(bytes, now_); }
  // Returns the next pair that has reached the host by now. Returns Fault::usage if a picture is invalid or
  // the recording has no pictures.
  Result<std::optional<vision::StereoPair>> next_pair();
  // Compares an entry of the behavior with the recorded entry.
  void think(const std::string& json);

  // Call this function after the host has finished. Detects recorded bytes and entries that the host did not
  // produce.
  void finish();
  // First difference in the bytes to the board. If all bytes are equal, but the host ends earlier or later
  // than in the recording, the end counts as the difference. Exception: if the recording is cut off, a later
  // end of the host does not count as a difference.
  const std::optional<HostDifference>& difference() const { return difference_; }
  // First difference between the recorded and the repeated entries of the behavior. This difference can
  // explain why the host sent different bytes to the board.
  const std::optional<HostDifference>& other_thought() const { return other_thought_; }

 private:
  void compare(std::span<const sim::SerialByte> arrived, sim::States end);
  void differ(std::span<const sim::SerialByte> arrived, std::size_t at);
  Result<void> stop(const std::string& why);
  tl::unexpected<Error> stop_for(Fault fault, const std::string& why);

  const RecordedRun& run_;
  sim::SerialLine line_;
  sim::States now_ = 0;
  // Number of items of the recording that were processed, for each kind of item.
  struct Processed {
    std::size_t compared = 0, given = 0, exposed = 0, thought = 0;
  };
  Processed processed_;
  std::vector<std::uint8_t> sent_;  // bytes that reached the board
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

// Returns a text about the byte at `offset` in the bytes from a host. The text contains the byte and its
// message. Example: "0x3a in `enable` #12 mask=0x3, frame 00 05 01 ...".
std::string byte_in_words(std::span<const std::uint8_t> sent, std::size_t offset);

}  // namespace kaz::lockstep
