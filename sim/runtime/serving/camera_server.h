// Publishes stereo pairs to other processes in the format of shared/base/camera_stream.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/runtime/serving/unix_listener.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// The server has its own thread, so neither rendering nor a slow reader blocks the caller of publish(). The
// server serves at most 8 readers and disconnects any further reader.
class CameraServer {
 public:
  // Listens on a Unix socket at `path`. Returns the errors of UnixListener::open().
  static Result<std::unique_ptr<CameraServer>> open(const std::string& path,
                                                    const vision::CameraModel& model, Time latency);
  ~CameraServer();

  // Queues a pair. `exposure` is a time on CLOCK_MONOTONIC. A reader that is still receiving an earlier pair
  // does not receive the new pair.
  void publish(vision::StereoPair pair, Time exposure);
  int readers() const { return reader_count_; }
  // Number of pairs that a reader did not receive, summed over all readers.
  std::uint64_t missed() const { return missed_; }

 private:
  using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;
  struct Reader {
    Descriptor socket;
    Bytes sending;         // null: the reader is idle
    std::size_t sent = 0;  // number of bytes of `sending` that are already sent
  };
  struct Published {
    vision::StereoPair pair;
    Time exposure;
  };

  CameraServer() = default;
  void run();
  void wake();
  void accept_readers();
  void serve_readers(const std::vector<short>& events);
  void send_pair(const Published& published);
  bool send_more(Reader& reader);  // returns false if the reader has disconnected

  std::unique_ptr<UnixListener> listener_;
  Descriptor wake_;  // eventfd
  Bytes header_;
  std::vector<Reader> readers_;  // accessed only by the server's thread
  std::atomic<int> reader_count_ = 0;
  std::atomic<std::uint64_t> missed_ = 0;
  std::mutex mutex_;
  std::deque<Published> queue_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace kaz::sim
