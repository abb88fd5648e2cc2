// Options of the robot and camera on which a behavior runs, from the command line or a recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/robot/robot_types.h"
#include "sim/runtime/simulation/robot_options.h"

namespace kaz::sim {
class HandSource;
class RecordingTap;
struct RobotModel;
}  // namespace kaz::sim

namespace kaz::tools {

struct BackendOptions : sim::RobotOptions {
  // "sim", a port (parse_port_address()), a servo bus (parse_bus()), or boards:FILE.
  std::string robot = "sim";
  std::uint8_t address = 1;                        // address of the board at a port
  double reconnect_s = 3;                          // time limit for reconnecting to a lost board
  host::Reaction reaction = host::Reaction::hold;  // reaction of the link watchdog
  std::string camera = "sim";                      // "sim", or an argument of open_live_camera()
  std::string calibration;                         // calibration file of real cameras
  bool needs_camera = true;                        // false: a robot at a port may have no camera
  std::string world = "ball";                      // for "sim" only, like all members below
  std::string robot_file;  // URDF file; empty: Kaz; also describes a robot at a port
  // Robot of robot_file, if the file has been read with `reading`; otherwise null. For a robot at a port, its
  // links have no bodies.
  std::shared_ptr<const sim::RobotModel> robot_model;
  // Joints of robot_file (other_joints()), for replays without this file.
  std::vector<std::string> joints;
  // Speed limits of the joints (joint_speeds()); empty on a servo bus, which has limits of its own.
  std::vector<std::string> joint_speeds;
  std::string image;   // firmware image for h8; empty: the installed image
  bool stand = false;  // simulates the motor test stand instead of robot and world
  // For the stand: motor file and name of a motor in it; empty: Kaz's motor.xml and its default motor.
  std::string motor_file, motor;
  double disc_kgm2 = 4e-4;  // moment of inertia of the disc on each shaft of the stand
  bool erased = false;      // the board's flash is erased and contains no firmware
  // Calibration and address in the board's flash (Mcu::memory), in hexadecimal; empty: blank memory.
  std::string memory;
  std::string faults;     // file with a schedule of faults; empty: no faults
  std::string recording;  // path of the recording; empty: no recording
  // Observer of the recorded messages. For a robot at a port, these are only the messages that the host can
  // record.
  sim::RecordingTap* tap = nullptr;
  sim::HandSource* hands = nullptr;  // SimulationOptions::hands
  double restore_every_s = 0;        // for tests: period of Simulation::detour(); 0: never
  bool record_pictures = false;
  bool verbose = false;  // list each element of the files of robot and world that Kaz does not use
  // Additional names and values for the header of the recording.
  std::vector<std::pair<std::string, std::string>> facts;

  bool at_port() const { return robot != "sim"; }

  // Pass options to an archive (robot_options.h).
  template <class A>
  void visit_world(A&& archive) {
    archive({"world", "--world", "name of a Kaz world, or an SDF file", "NAME|FILE"}, world);
    archive({"robot_file", "--robot-file",
             "URDF or MJCF of another robot; motor.xml and sensors.xml must be in the same "
             "folder (default: Kaz)",
             "FILE"},
            robot_file);
    visit_meshes(archive);
  }
  template <class A>
  void visit_image(A&& archive) {
    archive({"image", "--image", "firmware image for h8: an S-record or COFF file", "FILE"}, image);
  }
  // All options that describe the simulated robot, in the order of recordings.
  template <class A>
  void visit(A&& archive) {
    visit_world(archive);
    visit_mcu(archive);
    visit_image(archive);
    visit_sensors(archive);
    visit_dynamics(archive);
    visit_eyes(archive);
    visit_supply(archive);
    visit_seed(archive);
    archive({.name = "memory", .optional = true}, memory);
    visit_suspended(archive);
    archive({.name = "joints", .optional = true}, joints);
    archive({.name = "joint_speeds", .optional = true}, joint_speeds);
  }
};

}  // namespace kaz::tools
