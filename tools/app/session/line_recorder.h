// Records a run at a port: bytes that the host wrote and read, and reports of its behavior.
// SPDX-License-Identifier: Apache-2.0
//
// Writes the topics of a virtual robot's recording (docs/reference/recording.md) that a host can measure.
// Times count from the opening of the recording, on the host's clock. Bytes have the time after the write or
// read.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "sim/runtime/simulation/recorder.h"

namespace kaz::tools {

class LineRecorder {
 public:
  // Fact in such a recording: host clock, in ns, at which its times begin. Times in the texts of `/behavior`
  // are on the host's clock.
  static constexpr const char* kStart = "host_clock_start_ns";

  // Replaces the file. With an empty path only the tap receives messages. `clock` and `tap` must outlive the
  // recorder. Fails (environment) if the file cannot be written.
  static Result<std::unique_ptr<LineRecorder>> create(const std::string& path,
                                                      sim::McapWriter::Metadata facts,
                                                      const host::Clock& clock,
                                                      sim::MessageTap* tap = nullptr);

  // Returns a link that records its traffic as line `line`, the number of the board. The recorder owns it
  // until record() is called again for this line. `link` must outlive it.
  host::Link* record(host::Link& link, std::size_t line);
  // These functions, finish() and failed() are thread-safe, as are the recorded links.
  void behavior(const std::string& json);
  void map(const sim::RecordedMap& map);

  // Ends the recording and returns the SHA-256 of the file. Later calls return the same result.
  // `interrupted_by`: name of a signal, or empty.
  Result<std::string> finish(const std::string& interrupted_by);
  // Whether something could not be written.
  bool failed() const;

 private:
  class RecordedLink;
  LineRecorder(std::unique_ptr<sim::Recorder> recorder, const host::Clock& clock, Time start)
      : clock_(clock), start_(start), recorder_(std::move(recorder)) {}
  // Returns the time in the file's unit. It never decreases, because the messages of a file are in order.
  sim::States now();
  void wire(sim::Recorder::Direction direction, std::size_t line,
            std::span<const std::uint8_t> bytes);

  const host::Clock& clock_;
  Time start_;
  // For the members below; another thread ends a run whose plug-in crashed.
  mutable std::mutex mutex_;
  std::unique_ptr<sim::Recorder> recorder_;  // until finish()
  sim::States last_ = 0;
  Result<std::string> finished_;
  std::map<std::size_t, std::unique_ptr<host::Link>> links_;
};

}  // namespace kaz::tools
