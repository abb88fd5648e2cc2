// Options of the simulated robot, with one description of each option for command line, JSON and Python.
// SPDX-License-Identifier: Apache-2.0
//
// Each visit function passes some members to an archive, in a fixed order. An archive is a callable object
// that reads, writes or registers the values. The calls are:
//   archive(text, value)          bool, std::uint64_t, std::string (empty: not given), or a vector of strings
//   archive(text, value, values)  enum with to_string(), and the array of all its values
//   archive(text, value, range)   double, and an OptionRange
//   archive(text, value, sizes)   int, and the array of its valid values besides 0 (not given)
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "sim/board/sensor_file.h"
#include "sim/body/description/reading.h"
#include "sim/mcu/mcu_kind.h"
#include "sim/render/renderer_kind.h"
#include "sim/runtime/eyes/eye_kind.h"

namespace kaz::sim {

// Description of an option. The default of the option is the initial value of its member.
struct OptionText {
  const char* name;              // key in JSON, and keyword argument in Python
  const char* option = nullptr;  // option on the command line; null: only recordings have the value
  const char* help = "";         // help text of the command line
  const char* metavar = "";      // name of the value in the help text, such as "SECONDS"
  const char* opposite = nullptr;  // for a flag: help text of --no-NAME; null: no such option
  bool optional = false;           // true: JSON omits the default
};

// Inclusive range of a number. The default range contains all finite numbers.
struct OptionRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  const char* unit = "";
  bool limited() const { return max < std::numeric_limits<double>::infinity(); }
};

constexpr double kMinSupply_v = 1, kMaxSupply_v = 20;
constexpr std::array kEyeWidths{320, 640};  // px

struct RobotOptions {
  McuKind mcu = McuKind::h8;
  SensorSet sensors = SensorSet::nominal;
  bool imu = false;                  // true: the board has a gyro and an accelerometer
  std::string dynamics = "reduced";  // name of the dynamics (sim/body/world/world.h)
  double physics_step_ms = 1;        // duration of a physics step: 0.125, 0.25, 0.5, 1, 2 or 4 ms
  EyeKind eyes = EyeKind::ideal;
  int eye_width = 0;  // width of 4:3 pictures, px; 0: size from the camera file
  RendererKind renderer = kDefaultRenderer;
  double supply_volts = 10;  // kMinSupply_v to kMaxSupply_v
  std::uint64_t seed = 1;
  // True: the robot is suspended. The root link is fixed, and the feet do not touch the ground
  // (WorldOptions::hung).
  bool suspended = false;
  // How the robot's file is read. Only mesh_collision and skip_missing_meshes are options.
  ReadOptions reading;

  // Copies the options that determine the eyes' pictures.
  void copy_eyes(const RobotOptions& from) {
    eyes = from.eyes;
    eye_width = from.eye_width;
    renderer = from.renderer;
  }

  template <class A>
  void visit_mcu(A&& archive) {
    archive({"mcu", "--mcu",
             "h8: emulated board with the firmware image; native: the firmware's C code, compiled "
             "for this machine"},
            mcu, kMcuKinds);
  }
  template <class A>
  void visit_sensors(A&& archive) {
    archive({"sensors", "--sensors",
             "nominal: sensors with noise; ideal: sensors without noise; as-built: "
             "like nominal, but each potentiometer has an uncalibrated curve and "
             "offset of its own"},
            sensors, kSensorSets);
    archive({"imu", "--imu",
             "the board has a gyro and an accelerometer at its analog inputs AN3 to "
             "AN5",
             "", "the board has no gyro or accelerometer"},
            imu);
  }
  template <class A>
  void visit_dynamics(A&& archive) {
    archive({"dynamics", "--dynamics",
             "reduced: Kaz's own physics; exact: the Open Dynamics Engine (ODE); quickN: ODE with "
             "N iterations (1 to 1000)",
             "reduced|exact|quickN"},
            dynamics);
    archive({"physics_step_ms", "--physics-step",
             "time step of the dynamics: 0.125, 0.25, 0.5, 1, 2 or 4 ms; the firmware's tick "
             "stays at 1 ms. For impacts, choose a step of at most 1 ms. If the robot's motors "
             "are on, choose a step of at most 2 ms (docs/explanation/dynamics.md)",
             "MS"},
            physics_step_ms, OptionRange{});
  }
  template <class A>
  void visit_eyes(A&& archive) {
    archive({"eyes", "--eyes",
             "ideal: pinhole cameras without noise; real: rectified pictures from "
             "cameras that have lens errors, exposure and noise; none: no cameras, "
             "for behaviors that use no pictures"},
            eyes, kEyeKinds);
    archive({"eye_width", "--eye-width",
             "width of the eyes' pictures, px: 320 or 640 (default: the width in "
             "camera.json)",
             "320|640"},
            eye_width, kEyeWidths);
    archive({"renderer", "--renderer",
             "raster: Kaz's own renderer of the pictures; opengl: the reference "
             "renderer, which uses Mesa and takes three times as long as raster"},
            renderer, kRendererKinds);
  }
  template <class A>
  void visit_supply(A&& archive) {
    archive({"supply_volts", "--supply", "supply voltage of the board", "V"}, supply_volts,
            OptionRange{kMinSupply_v, kMaxSupply_v, "V"});
  }
  template <class A>
  void visit_seed(A&& archive) {
    archive({"seed", "--seed", "seed of all noise; equal seeds give equal results", "N"}, seed);
  }
  template <class A>
  void visit_meshes(A&& archive) {
    archive({.name = "mesh_collision",
             .option = "--mesh-collision",
             .help = "shape of meshes in collisions",
             .optional = true},
            reading.mesh_collision, kMeshCollisions);
    archive({.name = "skip_missing_meshes",
             .option = "--skip-missing-meshes",
             .help = "leave out meshes that do not exist",
             .optional = true},
            reading.skip_missing_meshes);
  }
  template <class A>
  void visit_suspended(A&& archive) {
    archive({"suspended", "--suspended",
             "hang the robot by its trunk, so that its feet are free. The command "
             "`kaz calibrate joints --only stops` needs a suspended robot",
             "", nullptr, true},
            suspended);
  }
};

}  // namespace kaz::sim
