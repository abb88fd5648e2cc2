// Plane candidates by a randomised Hough transform: local triples of cells vote for planes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/random.hpp"
#include "vision/planes/plane_cells.h"

namespace kaz::vision {

// Accumulator: the normal in 24 x 24 squares of the octahedral map (about 6 degrees each), the distance from
// the camera in 50 steps of 12 %, from 2 cm to 8 m. Optical frame.
class PlaneVotes {
 public:
  // Samples triples of cells where `open` is set and returns up to 6 planes with the most votes, best
  // first, no two of them in adjacent bins.
  std::span<const DisparityPlane> count(const CellGrid& grid, std::span<const std::uint8_t> open,
                                        std::span<const int> open_cells, const CameraModel& camera,
                                        int triples, Random& random);

 private:
  static constexpr int kSides = 24, kDistances = 50;
  struct Vote {
    std::array<std::int16_t, 3> bin;
    Eigen::Vector3f plane;  // scaled normal
  };
  // With a border of empty bins, so that each bin has neighbours.
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
  std::vector<std::uint16_t> bins_;  // all 0 but for those of votes_
  std::vector<Vote> votes_;
  std::vector<int> first_;  // of the votes of each bin, rising
  std::vector<Peak> peaks_;
  std::vector<DisparityPlane> best_;
};

}  // namespace kaz::vision
