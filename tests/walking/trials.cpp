// The trials of the table.
// SPDX-License-Identifier: Apache-2.0
#include "tests/walking/course.h"

namespace kaz::walking {
namespace {

std::string number(double value) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

Trial walk(std::string name) {
  return {.name = std::move(name), .options = {{"distance", "1"}}};
}

// On a floor of exactly this friction.
Trial turn(double mu, bool left, bool gyro) {
  Trial trial{.name = std::string(left ? "turn +45" : "turn -45") + ", mu " + number(mu) +
                      (gyro ? "" : ", no gyro"),
              .judged = Judged::turn,
              .behavior = left ? "turn-left" : "turn-right",
              .turn_deg = left ? 45.0 : -45.0,
              .mu = mu,
              .mu_spread = 0,
              .imu = gyro};
  return trial;
}

std::vector<Trial> make() {
  std::vector<Trial> all;
  all.push_back(walk("walk 1 m"));
  for (const double mu : {0.6, 0.7, 0.8}) all.push_back(turn(mu, mu != 0.7, true));
  all.push_back(walk("walk 1 m, no gyro"));
  all.back().imu = false;
  for (const double mu : {0.6, 0.7, 0.8}) all.push_back(turn(mu, mu != 0.7, false));
  all.push_back(walk("walk 1 m, as built"));
  all.back().sensors = "as-built";
  for (const double mu : {0.4, 0.5, 0.6, 0.8, 0.9, 1.0}) {
    all.push_back(walk("walk 1 m, mu " + number(mu)));
    all.back().mu = mu;
    all.back().mu_spread = 0;
  }
  for (const double mu : {0.4, 0.5, 0.9, 1.0}) all.push_back(turn(mu, true, true));
  for (const double volts : {9.0, 9.5, 10.5, 11.0}) {
    all.push_back(walk("walk 1 m, " + number(volts) + " V"));
    all.back().supply_volts = volts;
    all.push_back(turn(0.7, true, true));
    all.back().name = "turn +45, " + number(volts) + " V";
    all.back().supply_volts = volts;
  }
  for (const double push : {0.3, 0.4, 0.5, 0.6}) {
    Trial trial{.name = "stand, pushes " + number(push) + " Ns",
                .judged = Judged::stand,
                .behavior = "stand",
                .options = {{"posture", "home"}}};
    trial.push_ns = push;
    all.push_back(trial);
  }
  return all;
}

}  // namespace

const std::vector<Trial>& trials() {
  static const std::vector<Trial> all = make();
  return all;
}

}  // namespace kaz::walking
