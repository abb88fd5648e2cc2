// Sweeps the virtual robot's head while slow vision makes two maps of the floor.
// SPDX-License-Identifier: Apache-2.0
// Reproduces the paper's figure 7: the head has turned further before the result for a picture arrives. One
// map uses the eyes' pose at the exposure of the picture (frame information). The other map uses the eyes'
// pose at the arrival of the result.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/link/interrupt.h"
#include "host/map/local_map.h"
#include "shared/base/result.hpp"
#include "shared/base/time.hpp"
#include "sim/board/sensor_file.h"
#include "sim/mcu/mcu_kind.h"
#include "sim/runtime/eyes/eye_kind.h"
#include "sim/view/renderer_kind.h"
#include "tools/app/figures/frame_information/yard.h"

namespace kaz::figure7 {

struct Options {
  // world: path of yard.sdf. robot_folder: folder that contains kaz.urdf. image_path: firmware of the board,
  // needed for h8.
  std::string world, robot_folder, image_path;
  sim::McuKind mcu = sim::McuKind::h8;
  sim::EyeKind eyes = sim::EyeKind::real;
  sim::RendererKind renderer = sim::kDefaultRenderer;
  sim::SensorSet sensors = sim::SensorSet::nominal;
  int eye_width = 320;
  std::uint64_t seed = 1;
  double pan_deg = 50;  // largest angle of the head to each side
  double speed_deg_per_s = 60;
  // Angles of the head's tilt; the head sweeps once from side to side at each of these angles.
  std::vector<double> tilts_deg = {35, 20};
  // Time from the arrival of a pair to the arrival of its result.
  Time delay = std::chrono::milliseconds(300);
  map::LocalMapOptions map = {};
  host::Interrupt* interrupt = nullptr;          // ends the sweep; must outlive the call of sweep()
  std::function<void(Time, Time)> on_time = {};  // called with the robot's time and the final time
};

// One picture, and the size of the floor in both maps after its result.
struct SweptPicture {
  // Times of the exposure and of the arrival of the result.
  Time exposure{}, arrival{};
  double pan_then_rad = 0, pan_now_rad = 0;  // head angles at the exposure and at the arrival
  // Fraction of the left picture's pixels that show floor.
  double floor_share = 0;
  int floor_with = 0, floor_without = 0;  // number of floor cells in the maps after this result
};

struct Sweep {
  map::LocalMap with, without;  // maps made with and without frame information
  std::vector<EdgePoint> edges;
  std::vector<Box> boxes;  // in the map's frame
  std::vector<SweptPicture> swept;
  int pictures = 0, without_floor = 0;
  double fastest_rad_per_s = 0;  // fastest turn of the head between two exposures
  // Last picture taken with the head at the center: left eye, rectified.
  vision::Image eye;
};

// Fails if files are missing, if the board stopped or refused a request, if vision failed, or after an
// interrupt.
Result<Sweep> sweep(const Options& options);

}  // namespace kaz::figure7
