// Light, noise, exposure, colours, floors, motion.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/vision_table/robust_rows.h"

#include <cstdio>
#include <numbers>

namespace kaz::vision_table {
namespace {

std::string text(const char* format, double a, double b = 0) {
  char line[128];
  std::snprintf(line, sizeof line, format, a, b);
  return line;
}

void add_light(std::vector<RobustCase>& rows) {
  const auto add = [&](const std::string& name, const Conditions& c, bool learn = false) {
    rows.push_back({"light", name, c, "wood", sim::kRedBall, learn, false});
  };
  add("lamp above, as the simulator has it", {});
  Conditions dim;
  dim.exposure = 0.125;
  add("dim: an eighth of it", dim);
  Conditions side;
  side.light = {{-0.3, 0.9, 0.34}, 1.6, 0.35};
  add("strong, from the side, 20° high, hard shadows", side);
  Conditions overcast;
  overcast.light.key = 0;
  overcast.light.shaded = 1.6;
  add("no lamp, sky alone", overcast);
  Conditions warm;
  warm.tint = {1, 0.62, 0.30};  // about 2900 K, white balance left at 5500 K
  add("warm, no white balance", warm);
  add("warm, colour learned in it", warm, true);
  Conditions cold;
  cold.tint = {0.55, 0.78, 1};  // about 9000 K
  add("bluish, no white balance", cold);
  add("bluish, colour learned in it", cold, true);
}

void add_noise_and_exposure(std::vector<RobustCase>& rows) {
  for (const double factor : {2.0, 4.0}) {
    Conditions c;
    c.noise = factor;
    rows.push_back({"noise", text("%g times", factor), c});
  }
  for (const double factor : {0.25, 0.5, 2.0, 4.0}) {
    Conditions c;
    c.exposure = factor;
    rows.push_back({"exposure", text("%g times", factor), c});
  }
}

void add_colors(std::vector<RobustCase>& rows) {
  const struct {
    const char* name;
    sim::Rgb color;
  } balls[] = {{"red", sim::kRedBall},
               {"orange", {0.92F, 0.45F, 0.05F}},
               {"yellow", {0.90F, 0.80F, 0.10F}},
               {"green", {0.10F, 0.55F, 0.20F}},
               {"blue", {0.10F, 0.25F, 0.75F}},
               {"pink", {0.92F, 0.35F, 0.60F}}};
  for (const auto& b : balls) {
    RobustCase row{"ball's colour, learned from one picture", b.name, {}};
    row.ball = b.color;
    row.learn = true;
    rows.push_back(row);
  }
}

void add_floors(std::vector<RobustCase>& rows) {
  for (const char* floor : {"wood", "carpet", "checker", "plain"})
    rows.push_back({"floor", floor, {}, floor});
  rows.push_back(
      {"floor", "wood, with red and orange objects", {}, "wood", sim::kRedBall, false, true});
  rows.push_back({"floor", "the same, colour learned", {}, "wood", sim::kRedBall, true, true});
}

void add_motion(std::vector<RobustCase>& rows) {
  for (const double degrees : {30.0, 60.0, 120.0}) {
    for (const double ms : {5.0, 10.0, 20.0}) {
      Conditions c;
      c.turn_rad_s = degrees * std::numbers::pi / 180;
      c.exposure_s = 0.001 * ms;
      rows.push_back({"head turns while exposing", text("%g°/s, %g ms", degrees, ms), c});
    }
  }
}

}  // namespace

std::vector<RobustCase> robust_cases() {
  std::vector<RobustCase> rows;
  add_light(rows);
  add_noise_and_exposure(rows);
  add_colors(rows);
  add_floors(rows);
  add_motion(rows);
  return rows;
}

}  // namespace kaz::vision_table
