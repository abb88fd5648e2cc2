// Prints how far standing, steps on the spot and a rolling ball depend on the length of the physics step.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/studies/step_length/step_run.h"

namespace kaz::step_length {
namespace {

constexpr double kDegree = M_PI / 180;

bool print(const char* name, const Result<Course>& run, const Course& reference) {
  if (!run) {
    std::fprintf(stderr, "%s: %s\n", name, run.error().message.c_str());
    return false;
  }
  const Apart a = apart(*run, reference);
  std::printf("| %s | %.2f | %.2f | %.2f | %.2f | %.2f %% | %.3f | %.1f | %.2f |\n", name,
              1e3 * a.tracking, 1e3 * a.joints, 1e3 * a.trunk, a.turn / kDegree, 100 * a.force,
              1e3 * a.ball, run->largest_tilt / kDegree, run->physics_s);
  std::fflush(stdout);
  return true;
}

bool table(const char* name, Setting setting, Result<Course> (*go)(const Setting&)) {
  setting.step_ms = 0.125;
  const auto reference = go(setting);
  std::printf(
      "\n%s, %s, gain %.0f\n| step | tracking, mrad | joints, mrad | trunk, mm | heading, degrees "
      "| feet | ball, mm | largest tilt | wall s |\n|---|---|---|---|---|---|---|---|---|\n",
      name, setting.stepper.c_str(), setting.gain);
  if (!reference) {
    std::fprintf(stderr, "%s\n", reference.error().message.c_str());
    return false;
  }
  print("0.125 ms", reference, *reference);
  for (const auto& [text, step] :
       {std::pair{"0.25 ms", 0.25}, {"0.5 ms", 0.5}, {"1 ms", 1.0}, {"2 ms", 2.0}, {"4 ms", 4.0}}) {
    setting.step_ms = step;
    print(text, go(setting), *reference);
  }
  if (go == run_smooth) return true;
  // The scale for all this: the same again, begun 20 ms later. The ball is flicked when it was.
  setting.step_ms = 0.125;
  setting.lead_ms = 20;
  return print("0.125 ms, 20 ms later", go(setting), *reference);
}

int main(const char* stepper) {
  bool all = true;
  for (const auto& [name, load] : {std::pair{"stand", Load::stand}, {"walk", Load::walk}}) {
    for (const double gain : {20.0, 40.0, 80.0}) {
      const Setting setting{.load = load, .stepper = stepper, .gain = gain};
      all = table((std::string(name) + " smooth").c_str(), setting, run_smooth) && all;
      // With 40 the firmware takes a motor for stalled.
      if (gain == 20.0) all = table(name, setting, run) && all;
    }
  }
  return all ? 0 : 1;
}

}  // namespace
}  // namespace kaz::step_length

int main(int count, char** arguments) {
  return kaz::step_length::main(count > 1 ? arguments[1] : "reduced");
}
