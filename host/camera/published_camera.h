// Stereo pairs from another process, by way of a Unix socket (shared/base/camera_stream.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>

#include "host/camera/camera_stream.h"
#include "vision/image/frame.h"

namespace kaz::host {

class PublishedCamera final : public vision::Camera {
 public:
  // Size of the queue of pairs; if poll() is called too rarely, the oldest are dropped.
  static constexpr std::size_t kMostWaiting = 4;

  // Without a whole pair for this long, the camera has stopped: several times the longest interval of a
  // publisher (camera.json), so that one on a busy machine is waited for.
  static constexpr Time kSilence = std::chrono::seconds(5);

  // Connects and waits up to `patience` for the stream's header. Errors, each one sentence: nothing
  // is published at `path`, left over from a program that ended, no socket, permission, path too
  // long, no camera stream, another version, pictures of an impossible size, silence.
  static Result<std::unique_ptr<PublishedCamera>> connect(const std::string& path,
                                                          Time patience = std::chrono::seconds(2),
                                                          Time silence = kSilence);
  ~PublishedCamera() override;
  PublishedCamera(const PublishedCamera&) = delete;
  PublishedCamera& operator=(const PublishedCamera&) = delete;

  const vision::CameraModel& model() const override { return stream_.model; }
  // From the exposure to the time when poll() returns a pair, as declared by the publisher.
  Time latency() const { return stream_.latency; }

  // The error "camera PATH stopped: ..." once the publisher has ended or was silent for too long, and all
  // its pairs were returned.
  Result<std::optional<vision::StereoPair>> poll() override;

 private:
  PublishedCamera(std::string path, int socket, const CameraStream& stream, Time silence);
  void read_pairs();
  // Of the next pair; false: stopped.
  bool read(std::span<std::uint8_t> to, const char* part, Time deadline);
  void stop(Error error);

  const std::string path_;
  const int socket_;
  const CameraStream stream_;
  const Time silence_;
  std::mutex mutex_;
  std::deque<vision::StereoPair> waiting_;
  std::optional<Error> stopped_;
  std::thread reader_;  // last: it uses all of the above
};

}  // namespace kaz::host
