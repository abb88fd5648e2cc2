// Votes of local point triples for planes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/random.hpp"
#include "vision/planes/plane_cells.h"

namespace kaz::vision {

// Normals in 24 x 24 squares of an octahedron laid flat (some 6 degrees each), distances from the
// eye in steps of 12 %, from 2 cm to 8 m.
class PlaneVotes {
 public:
  // Draws triples among cells with `open` set and gives the planes most voted for, at most 6, best
  // first, none two next to each other.
  std::span<const DisparityPlane> count(const CellGrid& grid, std::span<const std::uint8_t> open,
                                        std::span<const int> open_cells, const CameraModel& camera,
                                        int triples, Random& random);

 private:
  static constexpr int kSides = 24, kDistances = 50;
  struct Vote {
    std::array<std::int16_t, 3> bin;
    Eigen::Vector3f plane;  // scaled normal
  };
  static int index(int x, int y, int z) { return (z * kSides + y) * kSides + x; }
  bool bin_of(const Eigen::Vector3d& plane, double baseline, Vote& vote) const;
  void draw(const CellGrid& grid, std::span<const std::uint8_t> open,
            std::span<const int> open_cells, const CameraModel& camera, int triples,
            Random& random);
  int around(const Vote& vote) const;

  std::vector<std::uint16_t> bins_;
  std::vector<Vote> votes_;
  std::vector<DisparityPlane> best_;
};

}  // namespace kaz::vision
