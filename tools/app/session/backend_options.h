// What a behaviour runs on, as the command line or a recording states it.
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

// Where none is given: a world in which the behaviour has something to do.
inline const char* usual_world(std::string_view behavior) {
  return behavior == "catch-ball" ? "catch" : behavior == "navigate" ? "boxes" : "ball";
}

struct BackendOptions {
  std::string robot = "sim";  // "sim", a port as parse_port_address() has it, or boards:FILE
  std::uint8_t address = 1;   // of the board at a port
  double reconnect_s = 3;     // how long a lost board is sought there
  host::Reaction reaction = host::Reaction::hold;  // of its link watchdog
  std::string camera = "sim";                      // "sim", or as open_live_camera() has it
  std::string calibration;                         // file; of real cameras
  bool needs_camera = true;                        // false: at a port the camera may be left out
  std::string world = "ball";                      // the rest for "sim" only
  std::string robot_file;           // URDF; Kaz if empty. At a port: of the robot there
  std::vector<std::string> joints;  // of that file (other_joints()); a replay has no file
  sim::McuKind mcu = sim::McuKind::h8;
  std::string image;              // firmware image for h8; the built one if empty
  bool stand = false;             // a motor stand instead of robot and world
  std::string motor_file, motor;  // of the stand; Kaz's motor.xml and its default if empty
  double disc_kgm2 = 4e-4;        // on each shaft of the stand
  bool erased = false;            // no image: the flash is blank
  // Calibration and address in the board's flash (Mcu::memory), in hexadecimal; none if empty.
  std::string memory;
  bool suspended = false;  // by the trunk, feet free
  sim::SensorSet sensors = sim::SensorSet::nominal;
  bool imu = false;  // the board's option
  sim::EyeKind eyes = sim::EyeKind::ideal;
  std::string dynamics = "reduced";  // WorldOptions::dynamics
  double physics_step_ms = 1;        // SimulationOptions
  double supply_volts = 10;          // kMinSupply_v to kMaxSupply_v
  int eye_width = 0;                 // 320 or 640; 0: as in camera.json
  sim::RendererKind renderer = sim::kDefaultRenderer;
  std::uint64_t seed = 1;
  std::string faults;                // file with a schedule of faults; none if empty
  std::string recording;             // path of the recording; none if empty
  sim::RecordingTap* tap = nullptr;  // SimulationOptions; at a port, of what the host knows
  sim::HandSource* hands = nullptr;  // SimulationOptions
  double restore_every_s = 0;        // detours of the simulation; 0: none
  bool record_pictures = false;
  // Of what runs on it, for the recording: name and value.
  std::vector<std::pair<std::string, std::string>> facts;
};

}  // namespace kaz::tools
