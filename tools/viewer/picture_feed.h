// Publishes pictures, camera calibrations and marks of the ball for viewers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/viewer/server.h"
#include "vision/color/ball.h"
#include "vision/image/frame.h"

namespace kaz::viewer {

class PictureFeed {
 public:
  // Adds the channels. `server` must outlive this object.
  explicit PictureFeed(Server& server);

  // Publishes the calibration of a pair. With `pixels`, also publishes the pictures of the pair as JPEG on
  // the channels of recorded pictures, at most 16 pairs per second. Waits until the pair is rendered. Call
  // this function on one thread only; this thread may run concurrently with the other functions.
  void pictures(const vision::StereoPair& pair, bool pixels);
  bool wants_pictures() const;
  // Adds a channel for derived pictures. Any thread may call this function and the next three functions. Only
  // one thread at a time may call wants_picture().
  std::uint32_t add_pictures(const std::string& topic);
  // Returns whether the channel has subscribers and the channel's next picture is due. At most 8 pictures per
  // second are due. If the function returns true, the picture counts as sent.
  bool wants_picture(std::uint32_t channel, const vision::FrameInfo& info);
  void picture(std::uint32_t channel, const vision::FrameInfo& info, const vision::Image& image);
  // Publishes an annotation of the left eye's picture that marks the ball. Without a ball, removes the mark.
  void ball(const vision::FrameInfo& info, const vision::BallObservation& ball);

 private:
  void camera(std::uint64_t time_ns, const vision::CameraModel& model,
              std::vector<std::uint8_t>& data);
  void jpeg(std::uint32_t channel, const vision::FrameInfo& info, const vision::Image& image,
            std::string_view frame);

  struct Channels {
    std::uint32_t left, right, left_info, right_info, annotations;
  };
  Server& server_;
  Channels channels_{};
  // Time at which the next pair is due; accessed by pictures() only.
  std::uint64_t next_picture_ns_ = 0;
  // For each channel: time at which the next picture is due. Accessed by wants_picture() only.
  std::map<std::uint32_t, std::uint64_t> next_made_ns_;
};

}  // namespace kaz::viewer
