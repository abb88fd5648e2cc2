// Sweeps the virtual robot's head while slow vision makes two maps of the floor.
// SPDX-License-Identifier: Apache-2.0
// The paper's figure 7: when a picture's result arrives, the head has turned on. One map enters the result at
// the eyes' pose at the exposure (frame information). The other map uses the eyes' pose when the result
// arrives.
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
  // world: yard.sdf. robot_folder: folder of kaz.urdf. image_path: firmware of the board, for h8.
  std::string world, robot_folder, image_path;
  sim::McuKind mcu = sim::McuKind::h8;
  sim::EyeKind eyes = sim::EyeKind::real;
  sim::RendererKind renderer = sim::kDefaultRenderer;
  sim::SensorSet sensors = sim::SensorSet::nominal;
  int eye_width = 320;
  std::uint64_t seed = 1;
  double pan_deg = 50;  // to each side
  double speed_deg_per_s = 60;
  std::vector<double> tilts_deg = {35, 20};     // one sweep each, from side to side
  Time delay = std::chrono::milliseconds(300);  // delay of vision after a pair's arrival
  map::LocalMapOptions map = {};
  host::Interrupt* interrupt = nullptr;          // ends the sweep; must outlive it
  std::function<void(Time, Time)> on_time = {};  // called with the robot's time and the final time
};

// One picture, and its floor in both maps.
struct SweptPicture {
  Time exposure{}, arrival{};                // times of the picture and of its result
  double pan_then_rad = 0, pan_now_rad = 0;  // head angles at these times
  double floor_share = 0;                    // share of the left picture's pixels
  int floor_with = 0, floor_without = 0;     // floor cells in the maps from then on
};

struct Sweep {
  map::LocalMap with, without;  // with and without frame information
  std::vector<EdgePoint> edges;
  std::vector<Box> boxes;  // in the map's frame
  std::vector<SweptPicture> swept;
  int pictures = 0, without_floor = 0;
  double fastest_rad_per_s = 0;  // fastest turn of the head between two exposures
  vision::Image eye;             // last picture of the center: left eye, rectified
};

// Fails if files are missing, the board stopped or refused a request, vision failed, or on an interrupt.
Result<Sweep> sweep(const Options& options);

}  // namespace kaz::figure7
