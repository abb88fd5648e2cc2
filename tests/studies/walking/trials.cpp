// The trials of the table.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/walking/course.h"

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
  all.back().sensors = sim::SensorSet::as_built;
  all.push_back(walk("walk 1 m, as built, calibrated"));
  all.back().sensors = sim::SensorSet::as_built;
  all.back().calibrated = true;
  for (const bool calibrated : {false, true}) {
    all.push_back(turn(0.7, false, true));
    all.back().name += std::string(", as built") + (calibrated ? ", calibrated" : "");
    all.back().sensors = sim::SensorSet::as_built;
    all.back().calibrated = calibrated;
  }
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
  for (const double push : {0.3, 0.4, 0.5, 0.6}) {
    for (const auto& [to, degrees] : {std::pair{"ahead", 0.0}, {"left", 90.0}, {"back", 180.0}}) {
      all.push_back(walk("walk 1 m, pushes " + number(push) + " Ns to " + to));
      all.back().push_ns = push;
      all.back().push_to_deg = degrees;
    }
  }
  for (const double push : {0.0, 0.3, 0.4, 0.5, 0.6}) {
    for (const char* balance : {"none", "learned"}) {
      if (push == 0 && std::string(balance) == "none") continue;
      all.push_back(walk("walk 1 m, balance " + std::string(balance) + ", pushes " + number(push) +
                         " Ns to the sides"));
      all.back().options["balance"] = balance;
      all.back().push_ns = push;
      all.back().push_sides = true;
    }
  }
  for (const auto& [to, degrees] : {std::pair{"ahead", 0.0}, {"left", 90.0}, {"back", 180.0}}) {
    all.push_back(walk(std::string("walk 1 m, balance learned, pushes 0.4 Ns to ") + to));
    all.back().options["balance"] = "learned";
    all.back().push_ns = 0.4;
    all.back().push_to_deg = degrees;
  }
  for (const auto& [to, degrees] :
       {std::pair{"ahead", 0.0}, {"back", 180.0}, {"to its left", 90.0}, {"to its right", -90.0}}) {
    Trial trial{
        .name = std::string("get up, fell ") + to, .judged = Judged::get_up, .behavior = "get-up"};
    trial.knocked_to_deg = degrees;
    all.push_back(trial);
    if (degrees != 0 && degrees != 180) continue;
    for (const double mu : {0.4, 1.0}) {
      all.push_back(trial);
      all.back().name += ", mu " + number(mu);
      all.back().mu = mu;
      all.back().mu_spread = 0;
    }
  }
  return all;
}

}  // namespace

const std::vector<Trial>& trials() {
  static const std::vector<Trial> all = make();
  return all;
}

}  // namespace kaz::walking
