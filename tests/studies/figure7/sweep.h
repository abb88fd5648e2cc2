// Sweeps the virtual robot's head while slow vision makes two maps of the floor.
// SPDX-License-Identifier: Apache-2.0
// Reproduces the paper's figure 7: the head has turned further before the result for a picture arrives. One
// map uses the eyes' pose at the exposure of the picture (frame information). The other map uses the eyes'
// pose at the arrival of the result.
#pragma once

#include <string>
#include <vector>

#include "host/map/local_map.h"
#include "shared/base/result.hpp"
#include "tests/studies/figure7/yard.h"

namespace kaz::figure7 {

struct Sweep {
  map::LocalMap with, without;  // maps made with and without frame information
  std::vector<EdgePoint> edges;
  int pictures = 0, without_floor = 0;
  double fastest_rad_per_s = 0;  // fastest turn of the head between two exposures
};

// `world`: path of yard.sdf. `robot_folder`: folder that contains kaz.urdf. `image`: firmware of the board.
// Fails if files are missing, if the board stopped or refused a request, or if vision failed.
Result<Sweep> sweep(const std::string& world, const std::string& robot_folder,
                    const std::string& image);

}  // namespace kaz::figure7
