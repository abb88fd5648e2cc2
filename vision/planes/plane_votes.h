// Finds plane candidates by a randomized Hough transform. Triples of neighboring cells vote for planes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/random.hpp"
#include "vision/planes/plane_cells.h"

namespace kaz::vision {

// Accumulator of votes for planes in the optical frame. The direction of the normal has 24 x 24 bins
// (octahedral map, about 6 degrees per bin). The distance from the camera has 50 bins from 2 cm to 8 m, each
// 12 % wide.
class PlaneVotes {
 public:
  // Draws triples of neighboring cells; a triple votes only if `open` is not 0 for all three cells. Returns
  // up to 6 planes with the most votes, best first. No two of these planes are in adjacent bins.
  // `open_cells` lists the numbers of all cells for which `open` is not 0. The result is valid until the
  // next call.
  std::span<const DisparityPlane> count(const CellGrid& grid, std::span<const std::uint8_t> open,
                                        std::span<const int> open_cells, const CameraModel& camera,
                                        int triples, Random& random);

 private:
  static constexpr int kSides = 24, kDistances = 50;
  struct Vote {
    std::array<std::int16_t, 3> bin;
    Eigen::Vector3f plane;  // scaled normal
  };
  // The accumulator has a border of empty bins, so that each bin has neighbors.
  static constexpr int kPitch = kSides + 2, kBins = kPitch * kPitch * (kDistances + 2);
  static std::size_t index(const Vote& vote) {
    return static_cast<std::size_t>(((vote.bin[2] + 1) * kPitch + vote.bin[1] + 1) * kPitch +
                                    vote.bin[0] + 1);
  }
  bool bin_of(const Eigen::Vector3d& plane, double baseline, Vote& vote) const;
  void sample(const CellGrid& grid, std::span<const std::uint8_t> open,
              std::span<const int> open_cells, const CameraModel& camera, int triples,
              Random& random);
  int votes_around(const Vote& vote) const;

  struct Peak {
    int votes, vote;
  };
  std::vector<std::uint16_t> bins_;  // number of votes in each bin
  std::vector<Vote> votes_;
  std::vector<int> first_;  // for each bin with votes: index of the bin's first vote in votes_
  std::vector<Peak> peaks_;
  std::vector<DisparityPlane> best_;
};

}  // namespace kaz::vision
