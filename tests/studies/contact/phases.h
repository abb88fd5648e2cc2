// Phases of a toss by the measured data, and how much of the error arises in each.
// SPDX-License-Identifier: Apache-2.0
//
// The score of a toss is the mean of e_1 .. e_n, the pose errors of its samples. An increment e_i - e_(i-1)
// stays in all later samples, so it contributes (e_i - e_(i-1)) (n - i + 1) / n. These contributions sum up
// to the score. Each belongs to the phase of the measured motion between the samples i - 1 and i:
//
//   flight        before the first impact. An impact is a change of the measured velocity by more than
//                 0.1 m/s beyond gravity, or of the angular velocity by more than 1 rad/s, in one sample
//   first impact  from the first impact to the next one that is more than 3 samples later
//   rocking       later: the angular velocity is at least 2 rad/s (tumbling, rocking, and flight in between)
//   sliding       later: slower rotation, and the horizontal speed is at least 0.05 m/s
//   rest          later: neither
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "tests/studies/contact/toss.h"

namespace kaz::contact {

enum class Phase { flight, first_impact, rocking, sliding, rest };
inline constexpr std::array<std::string_view, 5> kPhaseNames{"flight", "first impact", "rocking",
                                                             "sliding", "rest"};
using PhaseErrors = std::array<double, kPhaseNames.size()>;

// Returns the phase of each sample's interval to the previous sample; the first sample is in flight.
std::vector<Phase> phases_of(const Toss& toss);

// Returns the contribution of each phase to path_error(). A contribution may be negative.
PhaseErrors phase_errors(const Toss& toss, const Path& simulated);

// Returns the number (0 to 5) of the cube's face that is on top at the end of a path: +x, -x, +y, -y, +z, -z.
int final_face(const Path& path);

}  // namespace kaz::contact
