// The recording of a run at a port: what the host wrote and read, and when; what its behaviour reported.
// SPDX-License-Identifier: Apache-2.0
//
// The same topics as in the recording of a virtual robot (docs/reference/recording.md), of those that a host
// knows. Times count from the opening of the recording, on the host's clock; of bytes: when they were
// written, or had been read.
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
  // The fact of such a recording: on the host's clock, ns, where its times begin. Those in the texts of
  // `/behavior` are on that clock.
  static constexpr const char* kStart = "host_clock_start_ns";

  // Replaces the file; without a path nothing is written, and only the tap hears of it. `clock` and `tap`
  // must outlive the recorder. Errors (environment): it cannot be written.
  static Result<std::unique_ptr<LineRecorder>> create(const std::string& path,
                                                      sim::McapWriter::Metadata facts,
                                                      const host::Clock& clock,
                                                      sim::MessageTap* tap = nullptr);

  // A link that records what passes through it, as line `line`: the number of the board. The recorder owns
  // what is returned, until the line is recorded anew; `link` must outlive it.
  host::Link* record(host::Link& link, std::size_t line);
  void behavior(const std::string& json);
  void map(const sim::RecordedMap& map);

  // SHA-256 of the file. Nothing is recorded from then on. `interrupted_by`: a signal's name, or empty.
  // A second call returns what the first did.
  Result<std::string> finish(const std::string& interrupted_by);
  // Something could not be written.
  bool failed() const;

 private:
  class RecordedLink;
  LineRecorder(std::unique_ptr<sim::Recorder> recorder, const host::Clock& clock, Time start)
      : clock_(clock), start_(start), recorder_(std::move(recorder)) {}
  // On the scale of the file, never before that of an earlier call: messages of a file are in order.
  sim::States now();
  void wire(sim::Recorder::Direction direction, std::size_t line,
            std::span<const std::uint8_t> bytes);

  const host::Clock& clock_;
  Time start_;
  mutable std::mutex mutex_;  // of what follows; plug-ins are ended by another thread
  std::unique_ptr<sim::Recorder> recorder_;  // until finish()
  sim::States last_ = 0;
  Result<std::string> finished_;
  std::map<std::size_t, std::unique_ptr<host::Link>> links_;
};

}  // namespace kaz::tools
