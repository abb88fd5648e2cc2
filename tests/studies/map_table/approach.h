// Simulates a robot that walks towards a thing on a floor, and compares its map with ground truth.
// SPDX-License-Identifier: Apache-2.0
//
// Frame: between the feet at the start; x ahead, y left, z up, floor at z = 0. Units m, rad.
#pragma once

#include <cstdint>
#include <string>

#include "shared/base/result.hpp"
#include "sim/render/renderer_kind.h"
#include "tools/eval/obstacle.h"

namespace kaz::map_table {

enum class Thing { low_box, pole, can, box, dark_side };
struct ThingInfo {
  Thing thing;
  const char* name;
};
inline constexpr ThingInfo kThings[] = {{Thing::low_box, "box 2 cm high"},
                                        {Thing::pole, "pole of 5 mm"},
                                        {Thing::can, "can"},
                                        {Thing::box, "box"},
                                        {Thing::dark_side, "box, dark side of the lamp"}};
inline constexpr const char* kFloors[] = {"wood", "carpet", "checker", "plain"};

// Counts of what the map contains, for one thing or several.
struct Found {
  int things = 0, in_time = 0;  // in_time: in the map early enough to stop the robot
  int outline_points = 0, outline_found = 0, floor_cells = 0,
      floor_wrong = 0;  // tools/eval/map_truth.h

  void add(const Found& other);
};

// Runs one approach. `seed` determines size, color, position and light of the thing. The virtual eyes take a
// picture with noise, 320 px wide, at every centimeter. Posture and position have the errors of a walking
// robot. Errors: the renderer does not start.
Result<Found> approach(const std::string& floor, Thing thing, std::uint64_t seed,
                       sim::RendererKind renderer);

}  // namespace kaz::map_table
