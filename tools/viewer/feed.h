// Derives channels for viewers from the recorded channels: poses, joint states, board state and pictures.
// SPDX-License-Identifier: Apache-2.0
//
// docs/howto/watch.md lists the channels.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "shared/protocol/frame.h"
#include "sim/body/description/robot_model.h"
#include "tools/viewer/joint_poses.h"
#include "tools/viewer/picture_feed.h"
#include "tools/viewer/server.h"

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
  // Pictures of the same robot. Other threads may use this object while message() runs.
  PictureFeed& pictures() { return pictures_; }
  // Resets the derived state after a player has jumped to another time. Call this function on the thread of
  // message().
  void restart();

 private:
  struct Channels {
    std::uint32_t tf, joint_states, description, board;
  };

  Feed(Server& server, sim::RobotModel model, const FeedOptions& options);
  static Channels add_channels(Server& server, bool recorded_robot);
  void joints(std::uint64_t time_ns, std::span<const std::uint8_t> data);
  void joint_states(std::uint64_t time_ns, std::span<const double> angles,
                    std::span<const double> torques);
  void wire(std::uint64_t time_ns, std::size_t line, bool to_board,
            std::span<const std::uint8_t> data);
  void measured(std::uint64_t time_ns);
  void board_state(std::uint64_t time_ns);
  void set_status(std::uint64_t time_ns, std::uint16_t status);
  void poses_of_joints(std::uint64_t time_ns);

  // Limits the rate of poses and states.
  struct Rate {
    std::uint64_t period_ns;
    std::optional<std::uint64_t> next_ns = {};

    bool due(std::uint64_t time_ns);
  };
  // The board, as its messages and pins show it. `target` and `measured` in rad, `duty` from -1 to 1.
  struct BoardState {
    std::array<double, KZ_JOINTS> target{}, measured{}, duty{};
    std::uint16_t status = 0;
    double supply_v = 0;
    // Slowest tick that the board reported, as a fraction of the tick period.
    double worst_tick = 0;
    std::uint32_t frames_to_board = 0, frames_to_host = 0, frames_damaged = 0;
  };
  // State of the serial line to one board.
  struct Line {
    std::array<kz_receiver, 2> receivers{};
  };
  struct Wire {
    std::vector<Line> lines;
    // A joint belongs to the line that last set the joint's target.
    std::array<std::size_t, KZ_JOINTS> line_of{};
  };

  Server& server_;
  JointPoses poses_;
  Channels channels_;
  PictureFeed pictures_;
  Rate rate_;
  bool posed_ = false;      // true: the recorded channels contain poses
  bool has_truth_ = false;  // false: only the board's angles are known, as for a robot at a port
  std::vector<std::uint8_t> data_;  // reused buffer for the encoded message
  std::array<double, KZ_JOINTS> angle_{}, torque_{};
  BoardState board_;
  Wire wire_;
};

}  // namespace kaz::viewer
