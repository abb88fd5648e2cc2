// Records a run at a port: the bytes that the host wrote and read, and the reports of the behavior.
// SPDX-License-Identifier: Apache-2.0
//
// Writes those topics of a virtual robot's recording (docs/reference/recording.md) that a host can measure.
// Times count from the opening of the recording, on the host's clock. Recorded bytes have the time at which
// their write or read ended.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "host/link/link.h"
#include "sim/runtime/simulation/recorder.h"

namespace kaz::tools {

class LineRecorder {
 public:
  // Name of a fact in the recording: time in ns on the host's clock at which the times of the recording
  // begin. Times in the texts of `/behavior` are on the host's clock, and not relative to this start.
  static constexpr const char* kStart = "host_clock_start_ns";

  // Replaces the file at `path`. If `path` is empty, only the tap receives messages. `clock` and `tap` must
  // outlive the recorder. Fails (environment) if the file cannot be written.
  static Result<std::unique_ptr<LineRecorder>> create(const std::string& path,
                                                      sim::McapWriter::Metadata facts,
                                                      const host::Clock& clock,
                                                      sim::MessageTap* tap = nullptr);

  // Returns a link that passes calls on to `link` and records the traffic. `line`: number of the board. The
  // recorder owns the returned link until record() is called again for this line. `link` must outlive the
  // returned link.
  host::Link* record(host::Link& link, std::size_t line);
  // behavior(), map(), finish() and failed() are thread-safe. The recorded links are thread-safe, too.
  void behavior(const std::string& json);
  void map(const sim::RecordedMap& map);

  // Ends the recording and returns the SHA-256 of the file. Later calls return the same result.
  // `interrupted_by`: name of the signal that ended the run; empty if no signal did.
  Result<std::string> finish(const std::string& interrupted_by);
  // Returns whether a message could not be written.
  bool failed() const;

 private:
  class RecordedLink;
  LineRecorder(std::unique_ptr<sim::Recorder> recorder, const host::Clock& clock, Time start)
      : clock_(clock), start_(start), recorder_(std::move(recorder)) {}
  // Returns the present time in the unit of the recording. The returned time never decreases, because the
  // messages of a recording are in order of time.
  sim::States now();
  void wire(sim::Recorder::Direction direction, std::size_t line,
            std::span<const std::uint8_t> bytes);

  const host::Clock& clock_;
  Time start_;
  // Guards the members below, because another thread ends a run whose plug-in crashed.
  mutable std::mutex mutex_;
  std::unique_ptr<sim::Recorder> recorder_;  // null after finish()
  sim::States last_ = 0;
  Result<std::string> finished_;
  std::map<std::size_t, std::unique_ptr<host::Link>> links_;
};

}  // namespace kaz::tools
