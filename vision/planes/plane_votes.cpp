// Randomised Hough transform of local triples for planes.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/plane_votes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kaz::vision {
namespace {

constexpr int kReach = 6;            // cells from the first point of a triple to the others
constexpr double kNearest_m = 0.02;  // lower edge of the first bin of distance
constexpr float kStep = 0.12F;       // of the logarithm of distance
constexpr std::size_t kMaxPlanes = 6;
constexpr int kMinVotes = 3;  // of a peak

}  // namespace

// `plane`: B/D n (disparity_plane.h) with the baseline B, so its length is B/D.
//   distance bin: log(D / kNearest) / kStep, D = B / |plane|;
//   normal bin: octahedral map (Z. H. Cigolle et al., "A survey of efficient representations for
//   independent unit vectors", JCGT 3(2), 2014): n / |n|_1 projected to (x, y), the half z < 0 folded over
//   the diagonals, so that [-1, 1]^2 covers the sphere.
bool PlaneVotes::bin_of(const Eigen::Vector3d& plane, double baseline, Vote& vote) const {
  const double norm = plane.norm();
  if (!(norm > 1e-9)) return false;
  const double distance = baseline / norm;
  const float step = std::log(static_cast<float>(distance / kNearest_m)) / kStep;
  if (!(step >= 0 && step < kDistances)) return false;
  const Eigen::Vector3d n = plane / plane.lpNorm<1>();
  double x = n.x(), y = n.y();
  if (n.z() < 0) {
    x = std::copysign(1 - std::abs(n.y()), n.x());
    y = std::copysign(1 - std::abs(n.x()), n.y());
  }
  const auto side = [](double t) {
    return static_cast<std::int16_t>(
        std::clamp(static_cast<int>((t + 1) * 0.5 * kSides), 0, kSides - 1));
  };
  vote.bin = {side(x), side(y), static_cast<std::int16_t>(step)};
  vote.plane = plane.cast<float>();
  return true;
}

void PlaneVotes::sample(const CellGrid& grid, std::span<const std::uint8_t> open,
                        std::span<const int> open_cells, const CameraModel& camera, int triples,
                        Random& random) {
  bins_.resize(static_cast<std::size_t>(kBins));
  for (const Vote& vote : votes_) bins_[index(vote)] = 0;
  votes_.clear();
  first_.clear();
  // Twice the area of the triangle, px^2: smaller or thinner ones leave the slopes undetermined.
  const auto min_area = static_cast<float>(12 * grid.size * grid.size);
  for (int i = 0; i < triples; ++i) {
    const int first = open_cells[random.below(static_cast<std::uint32_t>(open_cells.size()))];
    const int column = first % grid.columns, row = first / grid.columns;
    const std::uint64_t bits = random.next();
    const auto near = [&](int shift) -> const Cell* {
      const int x = column + static_cast<int>((bits >> shift & 0xFFFF) % (2 * kReach + 1)) - kReach;
      const int y =
          row + static_cast<int>((bits >> (shift + 16) & 0xFFFF) % (2 * kReach + 1)) - kReach;
      if (x < 0 || y < 0 || x >= grid.columns || y >= grid.rows) return nullptr;
      const auto at = static_cast<std::size_t>(y * grid.columns + x);
      return open[at] != 0 ? &grid.cells[at] : nullptr;
    };
    const Cell& p = grid.cells[static_cast<std::size_t>(first)];
    const Cell *q = near(0), *r = near(32);
    if (q == nullptr || r == nullptr) continue;
    // Plane d = a u + b v + c through three points by Cramer's rule; u, v from the principal point, px.
    const float u1 = q->u - p.u, v1 = q->v - p.v, d1 = q->d - p.d;
    const float u2 = r->u - p.u, v2 = r->v - p.v, d2 = r->d - p.d;
    const float area = u1 * v2 - u2 * v1;
    if (std::abs(area) < min_area) continue;
    DisparityPlane plane;
    plane.a = (d1 * v2 - d2 * v1) / area;
    plane.b = (u1 * d2 - u2 * d1) / area;
    plane.c = p.d - plane.a * p.u - plane.b * p.v;
    Vote vote;
    if (!bin_of(plane.scaled_normal(camera), camera.baseline_m, vote)) continue;
    if (++bins_[index(vote)] == 1) first_.push_back(static_cast<int>(votes_.size()));
    votes_.push_back(vote);
  }
}

// Votes in the bin and its 26 neighbours, so that a plane on a border between bins is not split.
int PlaneVotes::votes_around(const Vote& vote) const {
  const std::uint16_t* middle = &bins_[index(vote)];
  int sum = 0;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      const std::uint16_t* row = middle + (z * kPitch + y) * kPitch;
      sum += row[-1] + row[0] + row[1];
    }
  }
  return sum;
}

std::span<const DisparityPlane> PlaneVotes::count(const CellGrid& grid,
                                                  std::span<const std::uint8_t> open,
                                                  std::span<const int> open_cells,
                                                  const CameraModel& camera, int triples,
                                                  Random& random) {
  sample(grid, open, open_cells, camera, triples, random);
  best_.clear();
  peaks_.clear();
  for (const int i : first_) {
    const Vote& vote = votes_[static_cast<std::size_t>(i)];
    const int votes = votes_around(vote);
    if (votes >= kMinVotes && bins_[index(vote)] != 0) peaks_.push_back({votes, i});
  }
  const auto beside = [](const Vote& a, const Vote& b, int reach) {
    return std::abs(a.bin[0] - b.bin[0]) <= reach && std::abs(a.bin[1] - b.bin[1]) <= reach &&
           std::abs(a.bin[2] - b.bin[2]) <= reach;
  };
  // Non-maximum suppression: a peak within 2 bins of a better one is skipped; of equal ones that of the
  // earliest vote is better. Few are taken, so none are sorted. The plane is the mean of all votes in the
  // peak's bin and its neighbours.
  while (best_.size() < kMaxPlanes && !peaks_.empty()) {
    const Peak peak =
        *std::max_element(peaks_.begin(), peaks_.end(),
                          [](const Peak& a, const Peak& b) { return a.votes < b.votes; });
    const Vote middle = votes_[static_cast<std::size_t>(peak.vote)];
    std::erase_if(peaks_, [&](const Peak& other) {
      return beside(middle, votes_[static_cast<std::size_t>(other.vote)], 2);
    });
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int n = 0;
    for (const Vote& vote : votes_) {
      if (!beside(vote, middle, 1)) continue;
      sum += vote.plane;
      ++n;
    }
    best_.push_back(DisparityPlane::of((sum / static_cast<float>(n)).cast<double>(), camera));
  }
  return best_;
}

}  // namespace kaz::vision
