// Derives channels for viewers from the recorded channels: poses, joint states, board state and pictures.
// SPDX-License-Identifier: Apache-2.0
//
// docs/howto/watch.md lists the channels.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "shared/protocol/frame.h"
#include "sim/body/description/robot_model.h"
#include "tools/viewer/server.h"
#include "vision/color/ball.h"
#include "vision/image/frame.h"

namespace kaz::viewer {

struct FeedOptions {
  double rate_hz = 30;  // rate of poses and states per second of the run's time
  // True: the recorded channels contain the robot's description, world and poses.
  bool recorded_robot = false;
  // Used for a robot without recorded poses. True: the robot hangs in the air. False: the robot stands on the
  // floor.
  bool hangs = false;
};

class Feed {
 public:
  // `server` must outlive this object. Fails if the robot file cannot be loaded.
  static Result<Feed> create(Server& server, const std::string& robot_path,
                             const FeedOptions& options = {});

  // Whether message() uses a recorded channel. `never`: message() ignores the channel. `for_viewers`:
  // messages of the channel may be skipped as long as there is no viewer. `always`: messages of the channel
  // must not be skipped. The channels of the wire and of poses have this value, because frames are counted
  // from the beginning.
  enum class Use { never, for_viewers, always };
  static Use use_of(std::string_view topic);
  // Processes a message of a recorded channel. All calls must come from the same thread.
  void message(std::string_view topic, std::uint64_t time_ns, std::span<const std::uint8_t> data);
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
  // Resets the derived state after a player has jumped to another time. Call this function on the thread of
  // message().
  void restart();

 private:
  Feed(Server& server, sim::RobotModel model, const FeedOptions& options);
  bool due(std::uint64_t time_ns);
  void joints(std::uint64_t time_ns, std::span<const std::uint8_t> data);
  void joint_states(std::uint64_t time_ns, std::span<const double> angles,
                    std::span<const double> torques);
  void wire(std::uint64_t time_ns, std::size_t line, bool to_board,
            std::span<const std::uint8_t> data);
  void measured(std::uint64_t time_ns);
  Eigen::Isometry3d standing(const std::vector<Eigen::Isometry3d>& links) const;
  void board_state(std::uint64_t time_ns);
  void set_status(std::uint64_t time_ns, std::uint16_t status);
  void poses_of_joints(std::uint64_t time_ns);
  void camera(std::uint64_t time_ns, const vision::CameraModel& model,
              std::vector<std::uint8_t>& data);

  void jpeg(std::uint32_t channel, const vision::FrameInfo& info, const vision::Image& image,
            std::string_view frame);

  struct Channels {
    std::uint32_t tf, joint_states, description, board, left, right, left_info, right_info,
        annotations;
  };
  Server& server_;
  sim::RobotModel model_;
  std::uint64_t period_ns_;
  Channels channels_{};
  std::optional<std::uint64_t> next_ns_;
  bool hangs_ = false;
  bool posed_ = false;      // true: the recorded channels contain poses
  bool has_truth_ = false;  // false: only the board's angles are known, as for a robot at a port
  std::vector<std::uint8_t> data_;  // reused buffer for the encoded message

  std::array<double, KZ_JOINTS> angle_{}, torque_{}, target_{}, measured_{}, duty_{};
  // State of the serial line to one board. A joint belongs to the line that last set the joint's target.
  struct Line {
    std::array<kz_receiver, 2> receivers{};
  };
  std::vector<Line> lines_;
  std::uint32_t frames_to_board_ = 0, frames_to_host_ = 0, frames_damaged_ = 0;
  double worst_tick_ = 0;  // slowest tick that the board reported, as a fraction of the tick period
  std::array<std::size_t, KZ_JOINTS> line_of_{};
  std::uint16_t status_ = 0;
  double supply_v_ = 0;
  // Time at which the next pair is due; accessed by pictures() only.
  std::uint64_t next_picture_ns_ = 0;
  // For each channel: time at which the next picture is due. Accessed by wants_picture() only.
  std::map<std::uint32_t, std::uint64_t> next_made_ns_;
};

}  // namespace kaz::viewer
