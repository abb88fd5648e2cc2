// Records all signals between the parts of the robot to an MCAP file. All time stamps are simulated times.
// SPDX-License-Identifier: Apache-2.0
//
// docs/reference/recording.md describes the channels.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/body/world/world.h"
#include "sim/mcu/mcu.h"
#include "sim/runtime/eyes/eyes.h"
#include "sim/runtime/formats/mcap_writer.h"
#include "sim/runtime/formats/ros_messages.h"
#include "sim/runtime/simulation/recorded_map.h"
#include "vision/image/frame.h"

namespace kaz::sim {

class Recorder {
 public:
  // Creates the file like McapWriter::create(). `facts` is written as the metadata record `kaz`.
  static Result<std::unique_ptr<Recorder>> create(const std::string& path,
                                                  const McapWriter::Metadata& facts,
                                                  MessageTap* tap = nullptr);

  enum class Direction { to_board, to_host };
  // Records bytes whose stop bit ended in the step that began at `step_start`. `line` is the number of the
  // serial line; the first line has number 0. Line 0 has the topics /wire/to_board and /wire/to_host. Line 1
  // has the topics /wire/2/to_board and /wire/2/to_host, and so on.
  void wire(Direction direction, States step_start, std::span<const SerialByte> bytes,
            std::size_t line = 0);
  void pins(States at, const PinLevels& pins);
  // Records the A/D codes that a tick of the firmware used.
  void analog(States at, const kz_tick_input& input);
  void joints(States at, std::span<const JointState, KZ_JOINTS> joints);
  void ball(States at, const Eigen::Vector3d& position);
  // Records supply voltage at the board (V) and supply current (A).
  void supply(States at, double volts, double amperes);
  void contacts(States at, std::span<const ContactPoint> points);
  // Records only the links that are in contact. `names` has the same indices as `links`.
  void link_forces(States at, std::span<const std::string> names, std::span<const LinkForce> links);
  void joint_loads(States at, std::span<const JointLoad, KZ_JOINTS> loads);
  // Records the digests of a picture pair. If `digest.kept` contains the pictures in PNG format, also records
  // the pictures.
  void eyes(const Eyes::Digest& digest);
  // Sets the calibration that is recorded with each picture.
  void camera(const vision::CameraModel& model) { camera_ = model; }
  // Records data for viewers. description() records the robot's URDF. scene() records all visuals of the
  // scene except the visuals whose frame is in `robot_frames`.
  void description(States at, std::string_view urdf);
  void scene(States at, const Scene& scene, std::span<const std::string> robot_frames);
  void transforms(States at, std::span<const ros::NamedPose> poses);
  void contact_markers(States at, std::span<const ContactPoint> points);
  void behavior(States at, std::string_view json);
  void map(States at, const RecordedMap& map);
  // Records the start of a fault. `line` is a line of a fault schedule (docs/reference/simulator.md).
  void fault(States at, std::string_view line);

  // Records a manual action. hand_player.h describes the format of `line`. The first call of hand() adds the
  // channel.
  void hand(States at, std::string_view line);

  // Adds the channels of the robot, the host's map, the camera calibration and manual actions to the file.
  // Call this function if a reader needs the schemas of these channels before their first messages.
  void add_all_channels();

  // Records that a signal, such as "SIGINT", interrupted the run.
  void interrupted(const std::string& by);
  // Like McapWriter::finish().
  Result<std::string> finish() { return file_->finish(); }
  // Like McapWriter::written().
  Result<void> written() const { return file_->written(); }

 private:
  struct MapChannels {
    std::uint16_t map, path, robot;
  };
  struct RobotChannels {
    std::uint16_t description, scene, transforms, contacts;
  };
  explicit Recorder(std::unique_ptr<McapWriter> file);
  void put(std::uint16_t channel, Time time);
  void picture(bool right, const Eyes::Digest& digest, std::span<const std::uint8_t> png);

  std::unique_ptr<McapWriter> file_;
  struct Line {
    std::uint16_t to_board, to_host;
  };
  std::vector<Line> lines_;
  std::uint16_t wire_bytes_, pins_, analog_, joints_, ball_, supply_, contacts_, link_forces_,
      joint_loads_, eyes_, left_eye_, right_eye_, behavior_, faults_;
  // Groups of channels. A group is empty until the first message of the group is recorded or
  // add_all_channels() is called.
  std::optional<MapChannels> maps_;
  std::optional<std::uint16_t> hands_;
  std::optional<std::array<std::uint16_t, 2>> camera_infos_;
  RobotChannels robot_channels();
  MapChannels map_channels();
  std::array<std::uint16_t, 2> camera_channels();
  std::uint16_t hand_channel();
  std::optional<RobotChannels> robot_;
  std::optional<vision::CameraModel> camera_;
  std::vector<std::uint8_t> data_;  // content of the current message
};

}  // namespace kaz::sim
