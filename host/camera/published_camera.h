// Stereo pairs from another process over a Unix socket (shared/base/camera_stream.hpp).
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
  // Size of the queue of pairs. If poll() is called too rarely, the oldest pairs are dropped.
  static constexpr std::size_t kMostWaiting = 4;

  // Timeout: if no complete pair came for this long, the camera counts as stopped. The timeout is several
  // times the longest interval of a publisher (camera.json), to tolerate a busy machine.
  static constexpr Time kSilence = std::chrono::seconds(5);

  // Connects and waits up to `patience` for the stream's header. `silence` replaces kSilence. Fails if `path`
  // is missing, too long, not a socket, not permitted, or left behind by an ended program. Also fails if no
  // header comes in time, or if the header is invalid (camera_stream.h).
  static Result<std::unique_ptr<PublishedCamera>> connect(const std::string& path,
                                                          Time patience = std::chrono::seconds(2),
                                                          Time silence = kSilence);
  ~PublishedCamera() override;
  PublishedCamera(const PublishedCamera&) = delete;
  PublishedCamera& operator=(const PublishedCamera&) = delete;

  const vision::CameraModel& model() const override { return stream_.model; }
  // Minimum time from a pair's exposure until poll() returns the pair. The publisher declares this time in
  // the header of the stream.
  Time latency() const { return stream_.latency; }

  // Returns a pair once latency() has passed since the pair's exposure. Fails with "camera PATH stopped: ..."
  // once the publisher has ended or timed out, and all pairs from the publisher were returned.
  Result<std::optional<vision::StereoPair>> poll() override;

 private:
  PublishedCamera(std::string path, int socket, const CameraStream& stream, Time silence);
  void read_pairs();
  // Reads bytes of the next pair into `to`. `part` names these bytes in error messages. Returns false if the
  // camera has stopped.
  bool read(std::span<std::uint8_t> to, const char* part, Time deadline);
  void stop(Error error);

  const std::string path_;
  const int socket_;
  const CameraStream stream_;
  const Time silence_;
  std::mutex mutex_;
  std::deque<vision::StereoPair> waiting_;
  std::optional<Error> stopped_;
  std::thread reader_;  // must be the last member: the thread uses the members above
};

}  // namespace kaz::host
