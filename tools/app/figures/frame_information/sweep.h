// The virtual robot in its crouch looks around, and slow vision makes a map of it, twice.
// SPDX-License-Identifier: Apache-2.0
//
// The paper's figure 7: a picture's result comes when the head has long turned on. Once it is put
// where the eyes were (frame information), once where they are when it comes.
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
  std::string world, robot_folder,
      image_path;  // yard.sdf; of kaz.urdf; the board's firmware, for h8
  sim::McuKind mcu = sim::McuKind::h8;
  sim::EyeKind eyes = sim::EyeKind::real;
  sim::RendererKind renderer = sim::kDefaultRenderer;
  sim::SensorSet sensors = sim::SensorSet::nominal;
  int eye_width = 320;
  std::uint64_t seed = 1;
  double pan_deg = 50;  // to each side
  double speed_deg_per_s = 60;
  std::vector<double> tilts_deg = {35, 20};     // one sweep each, from side to side
  Time delay = std::chrono::milliseconds(300);  // of vision, after a pair's arrival
  map::LocalMapOptions map = {};
  host::Interrupt* interrupt = nullptr;          // ends it; must outlive it
  std::function<void(Time, Time)> on_time = {};  // the robot's time so far, and that of the end
};

// One picture, its floor in both maps.
struct SweptPicture {
  Time exposure{}, arrival{};                // of its result
  double pan_then_rad = 0, pan_now_rad = 0;  // of the head at these times
  double floor_share = 0;                    // of the left picture's pixels
  int floor_with = 0, floor_without = 0;     // cells of floor in the maps from then on
};

struct Sweep {
  map::LocalMap with, without;  // frame information
  std::vector<EdgePoint> edges;
  std::vector<Box> boxes;  // in the map's frame
  std::vector<SweptPicture> swept;
  int pictures = 0, without_floor = 0;
  double fastest_rad_per_s = 0;  // of the head between two exposures
  vision::Image eye;             // of the last picture in the middle: left, rectified
};

// Errors: files; the board stopped or refused; vision failed; interrupted.
Result<Sweep> sweep(const Options& options);

}  // namespace kaz::figure7
