// Records all signals between the parts as an MCAP file, with simulated time only.
// SPDX-License-Identifier: Apache-2.0
//
// The channels are described in docs/explanation/time.md.
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
  // As McapWriter::create().
  static Result<std::unique_ptr<Recorder>> create(const std::string& path,
                                                  const McapWriter::Metadata& facts,
                                                  MessageTap* tap = nullptr);

  enum class Direction { to_board, to_host };
  // Bytes whose stop bit ended in the step that began at `step_start`. `line`: 0, or that of one of several
  // boards, which has topics of its own (/wire/2/to_board of line 1).
  void wire(Direction direction, States step_start, std::span<const SerialByte> bytes,
            std::size_t line = 0);
  void pins(States at, const PinLevels& pins);
  // A/D codes that a firmware tick used.
  void analog(States at, const kz_tick_input& input);
  void joints(States at, std::span<const JointState, KZ_JOINTS> joints);
  void ball(States at, const Eigen::Vector3d& position);
  // Supply voltage at the board (V) and current (A).
  void supply(States at, double volts, double amperes);
  void contacts(States at, std::span<const ContactPoint> points);
  // Links in contact only; `names` by link.
  void link_forces(States at, std::span<const std::string> names, std::span<const LinkForce> links);
  void joint_loads(States at, std::span<const JointLoad, KZ_JOINTS> loads);
  // With the pictures, if they were stored.
  void eyes(const Eyes::Digest& digest);
  // Calibration of the pictures, recorded with each of them.
  void camera(const vision::CameraModel& model) { camera_ = model; }
  // What viewers draw: the robot's URDF, and what stands in the world but for the robot's own frames.
  void description(States at, std::string_view urdf);
  void scene(States at, const Scene& scene, std::span<const std::string> robot_frames);
  void transforms(States at, std::span<const ros::NamedPose> poses);
  void contact_markers(States at, std::span<const ContactPoint> points);
  void behavior(States at, std::string_view json);
  void map(States at, const RecordedMap& map);
  // Start of a fault, as a line of docs/reference/faults.md.
  void fault(States at, std::string_view line);

  // What was done by hand, as a line of hand_player.h. The channel is there from the first one on.
  void hand(States at, std::string_view line);

  // Adds the channels that else are there from their first message on: for whoever wants all schemas.
  void add_all_channels();

  // States in the file that the run went on: "SIGINT".
  void interrupted(const std::string& by);
  // SHA-256 of the file.
  Result<std::string> finish() { return file_->finish(); }
  // Fails (environment) from the first write on that did not succeed.
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
  // From the first map on.
  std::optional<MapChannels> maps_;
  std::optional<std::uint16_t> hands_;
  // From the first picture on, and from the first of the robot.
  std::optional<std::array<std::uint16_t, 2>> camera_infos_;
  RobotChannels robot_channels();
  MapChannels map_channels();
  std::array<std::uint16_t, 2> camera_channels();
  std::uint16_t hand_channel();
  std::optional<RobotChannels> robot_;
  std::optional<vision::CameraModel> camera_;
  std::vector<std::uint8_t> data_;  // of the current message
};

}  // namespace kaz::sim
