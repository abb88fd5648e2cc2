// A robot that walks towards a thing on a floor, its eyes on it, and the map that it makes of both.
// SPDX-License-Identifier: Apache-2.0
//
// Frame: from between the feet of the start; x ahead, y left, z up, the floor z = 0. Units m, rad.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/view/renderer_kind.h"
#include "tools/app/evaluate/obstacle.h"

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

// What was found of one thing, or of several.
struct Found {
  int things = 0, in_time = 0;  // in_time: would have stopped the robot before it could be reached
  int outline_points = 0, outline_found = 0, floor_cells = 0,
      floor_wrong = 0;  // tools/app/evaluate/map_truth.h

  void add(const Found& other);
};

// Looks, size, colour, place and light by `seed`. Pictures are those of the virtual eyes with noise, 320 px
// wide, one a centimetre; posture and place err as a walking robot's do. Errors: the renderer does not start.
Result<Found> approach(const std::string& floor, Thing thing, std::uint64_t seed,
                       sim::RendererKind renderer);

}  // namespace kaz::map_table
