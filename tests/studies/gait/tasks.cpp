// The tasks of the tables.
// SPDX-License-Identifier: Apache-2.0
//
// Defaults: the trunk rolls by 16 degrees, the floor has a friction coefficient of 0.7.
#include "tests/studies/gait/episode.h"

namespace kaz::gait {
namespace {

Shape walk_shape(double roll_deg) {
  return {.roll = roll_deg * kDegree};
}
Shape turn_shape(double roll_deg) {
  return {.period = 1.8, .roll = roll_deg * kDegree};
}

std::vector<Task> make() {
  using V = Eigen::Vector2d;
  constexpr double k45 = 45 * kDegree;
  const Shape walk = walk_shape(16), wide = walk_shape(20);
  const Shape turn = turn_shape(16), wide_turn = turn_shape(20);
  // Our own, not of the reference: slow enough for single support on every floor.
  const Shape slow_turn{.period = 2.2, .roll = 22 * kDegree};
  const auto turning = [](std::string name, Shape shape, double mu, double angle,
                          std::string reference) {
    return Task{.name = std::move(name),
                .kind = Kind::turn,
                .shape = shape,
                .mu = mu,
                .turn = angle,
                .reference = std::move(reference)};
  };
  const auto spinning = [](std::string name, Shape shape, double mu) {
    return Task{.name = std::move(name),
                .kind = Kind::spin,
                .shape = shape,
                .mu = mu,
                .reference = mu == 0.7 && shape.period < 2 ? "about 23 deg, ± 1 to 2" : "-"};
  };
  const auto grabbing = [](std::string name, std::vector<V> off, std::string reference) {
    return Task{.name = std::move(name),
                .kind = Kind::grab,
                .off = std::move(off),
                .reference = std::move(reference)};
  };
  return {
      {.name = "walk 0.5 m, roll 20",
       .shape = wide,
       .reference = "0/6, 4.8 cm/s, mean 0.47, max 1.04 deg, 11 mm, 11.1 s"},
      {.name = "walk 0.5 m, no heading hold",
       .shape = walk,
       .hold_heading = false,
       .reference = "0/6, mean 1.1, max 1.9 deg"},
      {.name = "walk 1.0 m",
       .shape = walk,
       .distance = 1.0,
       .reference = "0/4, 5.1 cm/s, max 3.3 deg, 30 mm"},
      {.name = "walk 0.5 m, mu 0.4", .shape = walk, .mu = 0.4, .reference = "0/4, max 0.4 deg"},
      {.name = "walk 0.5 m, mu 1.0", .shape = walk, .mu = 1.0, .reference = "0/4, max 0.4 deg"},
      {.name = "walk, pushes 0.1 Ns",
       .shape = walk,
       .push_ns = 0.1,
       .reference = "0/6, max 0.9 deg"},
      {.name = "walk, pushes 0.3 Ns",
       .shape = walk,
       .push_ns = 0.3,
       .reference = "0/6, 4.4 cm/s, mean 4.8, max 8.2 deg"},
      turning("turn +45, roll 20", wide_turn, 0.7, k45, "0/6, 47.2 ± 1.2 deg, 6.1 s, 20 mm"),
      turning("turn -45, roll 20", wide_turn, 0.7, -k45, "0/6, -47.0 ± 0.8 deg, 5.8 s"),
      turning("turn +45, mu 0.4", turn, 0.4, k45, "0/6, 48.0 ± 0.8 deg, 7.4 s"),
      turning("turn +45, mu 1.0", turn, 1.0, k45, "0/6, 47.3 ± 1.1 deg, 6.7 s"),
      turning("slow turn +45, mu 0.4", slow_turn, 0.4, k45, "-"),
      turning("slow turn +45, mu 0.7", slow_turn, 0.7, k45, "-"),
      turning("slow turn +45, mu 1.0", slow_turn, 1.0, k45, "-"),
      spinning("turn 3 cycles, roll 20, mu 0.4", wide_turn, 0.4),
      spinning("turn 3 cycles, roll 20, mu 0.7", wide_turn, 0.7),
      spinning("turn 3 cycles, roll 20, mu 1.0", wide_turn, 1.0),
      spinning("slow turn 3 cycles, mu 0.4", slow_turn, 0.4),
      spinning("slow turn 3 cycles, mu 0.7", slow_turn, 0.7),
      spinning("slow turn 3 cycles, mu 1.0", slow_turn, 1.0),
      {.name = "stand, pushes 0.45 Ns",
       .kind = Kind::stand,
       .push_ns = 0.45,
       .push_every_s = 1.5,
       .reference = "survives (falls at 0.6 Ns)"},
      grabbing("catch", {V(0, 0)}, "12/12"),
      grabbing("catch, ball off in x by 10, 20 mm",
               {V(-0.02, 0), V(-0.01, 0), V(0.01, 0), V(0.02, 0)}, "2/2 each"),
      grabbing("catch, ball off in y by 10 mm", {V(0, -0.01), V(0, 0.01)}, "2/2 each"),
      grabbing("catch, ball off in y by 20 mm", {V(0, -0.02), V(0, 0.02)}, "0/2 each"),
  };
}

}  // namespace

const std::vector<Task>& tasks() {
  static const std::vector<Task> all = make();
  return all;
}

}  // namespace kaz::gait
