// Options of the simulated robot, with one description of each option for command line, JSON and Python.
// SPDX-License-Identifier: Apache-2.0
//
// Each visit function passes some members to an archive, in a fixed order. An archive reads, writes or
// registers the values. Its member functions are:
//   choice(text, value, values)  an enum with to_string(), and the array of all its values
//   flag(text, value)            bool
//   line(text, value)            std::string; empty: not given
//   lines(text, value)           std::vector<std::string>; only in recordings
//   number(text, value)          any finite double
//   number(text, value, range)   double in an OptionRange
//   whole(text, value)           std::uint64_t
//   size(text, value, sizes)     int: one of the array `sizes`, or 0 if not given
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "sim/board/sensor_file.h"
#include "sim/mcu/mcu_kind.h"
#include "sim/render/renderer_kind.h"
#include "sim/runtime/eyes/eye_kind.h"

namespace kaz::sim {

// Description of an option. The default of the option is the initial value of its member.
struct OptionText {
  const char* name;              // key in JSON, and keyword argument in Python
  const char* option = nullptr;  // option on the command line; null: only recordings have the value
  const char* help = "";         // help text of the command line
  const char* placeholder = "";  // type of the value in the help text
  const char* opposite = nullptr;  // for a flag: help text of --no-NAME; null: no such option
  bool optional = false;           // true: JSON omits the default
};

// Inclusive range of a number.
struct OptionRange {
  double min, max;
  const char* unit;
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

  // Copies the options that determine the eyes' pictures.
  void copy_eyes(const RobotOptions& from) {
    eyes = from.eyes;
    eye_width = from.eye_width;
    renderer = from.renderer;
  }

  template <class A>
  void visit_mcu(A& archive) {
    archive.choice({.name = "mcu",
                    .option = "--mcu",
                    .help = "microcontroller of the servo board: h8 executes the firmware image; "
                            "native runs the firmware's C code, compiled for this machine"},
                   mcu, kMcuKinds);
  }
  template <class A>
  void visit_sensors(A& archive) {
    archive.choice({.name = "sensors",
                    .option = "--sensors",
                    .help = "nominal: sensors with noise; ideal: sensors without noise; as-built: "
                            "like nominal, but each potentiometer has an uncalibrated curve and "
                            "offset of its own"},
                   sensors, kSensorSets);
    archive.flag({.name = "imu",
                  .option = "--imu",
                  .help = "the board has a gyro and an accelerometer at its analog inputs AN3 to "
                          "AN5",
                  .opposite = "the board has no gyro or accelerometer"},
                 imu);
  }
  template <class A>
  void visit_dynamics(A& archive) {
    archive.line({.name = "dynamics",
                  .option = "--dynamics",
                  .help = "reduced: Kaz's own physics engine; exact: the Open Dynamics Engine; "
                          "quickN: the Open Dynamics Engine with N iterations (1 to 1000)",
                  .placeholder = "reduced|exact|quickN"},
                 dynamics);
    archive.number(
        {.name = "physics_step_ms",
         .option = "--physics-step",
         .help = "time step of the dynamics: 0.125, 0.25, 0.5, 1, 2 or 4 ms; the firmware's tick "
                 "stays at 1 ms. For impacts, choose a step of at most 1 ms. If the robot's motors "
                 "are on, choose a step of at most 2 ms (docs/explanation/dynamics.md)",
         .placeholder = "MS"},
        physics_step_ms);
  }
  template <class A>
  void visit_eyes(A& archive) {
    archive.choice({.name = "eyes",
                    .option = "--eyes",
                    .help = "ideal: pinhole cameras without noise; real: rectified pictures from "
                            "cameras that have lens errors, exposure and noise; none: no cameras, "
                            "for behaviors that use no pictures"},
                   eyes, kEyeKinds);
    archive.size({.name = "eye_width",
                  .option = "--eye-width",
                  .help = "width of the eyes' pictures, px: 320 or 640 (default: the width in "
                          "camera.json)",
                  .placeholder = "320|640"},
                 eye_width, kEyeWidths);
    archive.choice({.name = "renderer",
                    .option = "--renderer",
                    .help = "raster: Kaz's own renderer of the pictures; opengl: the reference "
                            "renderer, which uses Mesa and takes three times as long as raster"},
                   renderer, kRendererKinds);
  }
  template <class A>
  void visit_supply(A& archive) {
    archive.number({.name = "supply_volts",
                    .option = "--supply",
                    .help = "supply voltage of the board",
                    .placeholder = "V"},
                   supply_volts, OptionRange{kMinSupply_v, kMaxSupply_v, "V"});
  }
  template <class A>
  void visit_seed(A& archive) {
    archive.whole({.name = "seed",
                   .option = "--seed",
                   .help = "seed of all noise; the same seed gives identical results",
                   .placeholder = "N"},
                  seed);
  }
  template <class A>
  void visit_suspended(A& archive) {
    archive.flag({.name = "suspended",
                  .option = "--suspended",
                  .help = "hang the robot by its trunk, so that its feet are free. The command "
                          "`kaz calibrate joints --only stops` needs a suspended robot",
                  .optional = true},
                 suspended);
  }
};

}  // namespace kaz::sim
