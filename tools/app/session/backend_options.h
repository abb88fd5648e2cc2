// Options of the robot and camera on which a behavior runs, from the command line or a recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/robot/robot_types.h"
#include "sim/board/sensor_file.h"
#include "sim/mcu/mcu_kind.h"
#include "sim/runtime/eyes/eye_kind.h"
#include "sim/view/renderer_kind.h"

namespace kaz::sim {
class HandSource;
class RecordingTap;
}  // namespace kaz::sim

namespace kaz::tools {

constexpr double kMinSupply_v = 1, kMaxSupply_v = 20;

// Returns the default world: one that contains what the behavior needs.
inline const char* usual_world(std::string_view behavior) {
  return behavior == "catch-ball" ? "catch" : behavior == "navigate" ? "boxes" : "ball";
}

struct BackendOptions {
  // "sim", a port (parse_port_address()), a servo bus (parse_bus()), or boards:FILE.
  std::string robot = "sim";
  std::uint8_t address = 1;                        // address of the board at a port
  double reconnect_s = 3;                          // how long to try to reconnect to a lost board
  host::Reaction reaction = host::Reaction::hold;  // reaction of the link watchdog
  std::string camera = "sim";                      // "sim", or an argument of open_live_camera()
  std::string calibration;                         // file, for real cameras
  bool needs_camera = true;                        // false: no camera is necessary at a port
  std::string world = "ball";                      // this and the rest are for "sim" only
  std::string robot_file;           // URDF; Kaz if empty. Also describes the robot at a port.
  std::vector<std::string> joints;  // joints of robot_file (other_joints()); a replay has no file
  sim::McuKind mcu = sim::McuKind::h8;
  std::string image;              // firmware image for h8; the installed one if empty
  bool stand = false;             // motor test stand instead of robot and world
  std::string motor_file, motor;  // for the stand; empty: Kaz's motor.xml and its default motor
  double disc_kgm2 = 4e-4;        // inertia on each shaft of the stand
  bool erased = false;            // blank flash, no image
  // Calibration and address in the board's flash (Mcu::memory), in hexadecimal; empty: none.
  std::string memory;
  bool suspended = false;  // held at the trunk, with free feet
  sim::SensorSet sensors = sim::SensorSet::nominal;
  bool imu = false;  // the board has the optional IMU
  sim::EyeKind eyes = sim::EyeKind::ideal;
  std::string dynamics = "reduced";  // WorldOptions::dynamics
  double physics_step_ms = 1;        // SimulationOptions::physics_step_ms
  double supply_volts = 10;          // kMinSupply_v to kMaxSupply_v
  int eye_width = 0;                 // px: 320 or 640; 0: as in camera.json
  sim::RendererKind renderer = sim::kDefaultRenderer;
  std::uint64_t seed = 1;
  std::string faults;     // file with a schedule of faults; none if empty
  std::string recording;  // path of the recording; none if empty
  // Observer of the recorded messages; at a port, those of the host.
  sim::RecordingTap* tap = nullptr;
  sim::HandSource* hands = nullptr;  // SimulationOptions::hands
  double restore_every_s = 0;        // for tests: period of Simulation::detour(); 0: never
  bool record_pictures = false;
  // Names and values for the header of the recording.
  std::vector<std::pair<std::string, std::string>> facts;
};

}  // namespace kaz::tools
