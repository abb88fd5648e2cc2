// What viewers get beside the recorded channels, made of these: poses, joint states, markers, the board.
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
#include "tools/view/server.h"
#include "vision/color/ball.h"
#include "vision/image/frame.h"

namespace kaz::watch {

struct FeedOptions {
  double rate_hz = 30;  // of poses and states, in the run's time
  bool recorded_robot =
      false;           // the recorded channels have the robot's description, world and poses
  bool hangs = false;  // a robot without them hangs in the air; else it stands
};

class Feed {
 public:
  // The server must outlive it.
  static Result<Feed> create(Server& server, const std::string& robot_path,
                             const FeedOptions& options = {});

  // Which recorded channels message() reads. Those `for_viewers` may be left out while there is no viewer.
  // The wire is always read: its frames are counted from the beginning.
  enum class Use { never, for_viewers, always };
  static Use use_of(std::string_view topic);
  // A message of a recorded channel. Always on the same thread.
  void message(std::string_view topic, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  // A pair of the host's: calibration and, with `pixels`, as JPEG in the channels of recorded pictures.
  // Waits until the pair is drawn. May run beside calls of the other functions, on one thread.
  void pictures(const vision::StereoPair& pair, bool pixels);
  bool wants_pictures() const;
  // A channel of pictures made for viewers, 8 a second at most. From any thread, as the next three.
  std::uint32_t add_pictures(const std::string& topic);
  // Whether somebody wants the picture, and it is due. Each answer of yes counts as that picture.
  bool wants_picture(std::uint32_t channel, const vision::FrameInfo& info);
  void picture(std::uint32_t channel, const vision::FrameInfo& info, const vision::Image& image);
  // Marks the ball on the left eye's picture, or that there is none.
  void ball(const vision::FrameInfo& info, const vision::BallObservation& ball);
  // The player goes back: forgets what it derived. On the thread of message().
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
  bool posed_ = false;              // poses come with the recorded channels
  bool has_truth_ = false;          // false: at a port, where the board's angles are all there is
  std::vector<std::uint8_t> data_;  // of the message under way

  std::array<double, KZ_JOINTS> angle_{}, torque_{}, target_{}, measured_{}, duty_{};
  // Of each board's line. A joint is that board's whose host last set its target.
  struct Line {
    std::array<kz_receiver, 2> receivers{};
  };
  std::vector<Line> lines_;
  std::uint32_t frames_to_board_ = 0, frames_to_host_ = 0, frames_damaged_ = 0;
  double worst_tick_ = 0;  // share of a tick's time
  std::array<std::size_t, KZ_JOINTS> line_of_{};
  std::uint16_t status_ = 0;
  double supply_v_ = 0;
  std::uint64_t next_picture_ns_ = 0;                    // of pictures() alone
  std::map<std::uint32_t, std::uint64_t> next_made_ns_;  // of wants_picture() alone, by channel
};

}  // namespace kaz::watch
