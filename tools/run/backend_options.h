// Options of the robot and camera on which a behavior runs, from the command line or a recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/robot/robot_types.h"
#include "sim/board/sensor_file.h"
#include "sim/mcu/mcu_kind.h"
#include "sim/render/renderer_kind.h"
#include "sim/runtime/eyes/eye_kind.h"

namespace kaz::sim {
class HandSource;
class RecordingTap;
}  // namespace kaz::sim

namespace kaz::tools {

constexpr double kMinSupply_v = 1, kMaxSupply_v = 20;

struct BackendOptions {
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
  // Joints of robot_file (other_joints()), for replays without this file.
  std::vector<std::string> joints;
  sim::McuKind mcu = sim::McuKind::h8;
  std::string image;   // firmware image for h8; empty: the installed image
  bool stand = false;  // simulates the motor test stand instead of robot and world
  // For the stand: motor file and name of a motor in it; empty: Kaz's motor.xml and its default motor.
  std::string motor_file, motor;
  double disc_kgm2 = 4e-4;  // moment of inertia of the disc on each shaft of the stand
  bool erased = false;      // the board's flash is erased and contains no firmware
  // Calibration and address in the board's flash (Mcu::memory), in hexadecimal; empty: blank memory.
  std::string memory;
  bool suspended = false;  // the robot is held at the trunk, and the feet are free
  sim::SensorSet sensors = sim::SensorSet::nominal;
  bool imu = false;  // true: the board has the optional IMU
  sim::EyeKind eyes = sim::EyeKind::ideal;
  std::string dynamics = "reduced";  // WorldOptions::dynamics
  double physics_step_ms = 1;        // SimulationOptions::physics_step_ms
  double supply_volts = 10;          // kMinSupply_v to kMaxSupply_v
  // Width of the eyes' pictures, px: 320 or 640; 0: the width in camera.json.
  int eye_width = 0;
  sim::RendererKind renderer = sim::kDefaultRenderer;
  std::uint64_t seed = 1;
  std::string faults;     // file with a schedule of faults; empty: no faults
  std::string recording;  // path of the recording; empty: no recording
  // Observer of the recorded messages. For a robot at a port, these are only the messages that the host can
  // record.
  sim::RecordingTap* tap = nullptr;
  sim::HandSource* hands = nullptr;  // SimulationOptions::hands
  double restore_every_s = 0;        // for tests: period of Simulation::detour(); 0: never
  bool record_pictures = false;
  // Additional names and values for the header of the recording.
  std::vector<std::pair<std::string, std::string>> facts;

  bool at_port() const { return robot != "sim"; }
};

}  // namespace kaz::tools
