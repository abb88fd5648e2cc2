// step_length: deviation of standing, stepping and a rolling ball by the length of the physics step.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <CLI/CLI.hpp>

#include "shared/base/angle.hpp"
#include "tests/studies/common/program.h"
#include "tests/studies/common/table.h"
#include "tests/studies/step_length/step_run.h"

namespace kaz::step_length {
namespace {

using studies::text;

Result<void> add_row(studies::MarkdownTable& table, const char* name, const Result<Course>& run,
                     const Course& reference) {
  if (!run) return fail(run.error().fault, std::string(name) + ": " + run.error().message);
  const Deviation d = deviation(*run, reference);
  table.add({name, text("%.2f", 1e3 * d.tracking), text("%.2f", 1e3 * d.joints),
             text("%.2f", 1e3 * d.trunk), text("%.2f", d.heading / kDegree),
             text("%.2f %%", 100 * d.force), text("%.3f", 1e3 * d.ball),
             text("%.1f", run->max_tilt / kDegree), text("%.2f", run->physics_s)});
  return {};
}

// Runs all step lengths, prints the table and appends it to `tables`.
Result<void> measure(const std::string& name, Setting setting, Result<Course> (*go)(const Setting&),
                     std::string& tables) {
  setting.step_ms = 0.125;
  const auto reference = go(setting);
  if (!reference) return tl::unexpected(reference.error());
  studies::MarkdownTable table({"step", "tracking, mrad", "joints, mrad", "trunk, mm",
                                "heading, degrees", "feet", "ball, mm", "max tilt", "wall s"});
  auto done = add_row(table, "0.125 ms", reference, *reference);
  for (const auto& [label, step] :
       {std::pair{"0.25 ms", 0.25}, {"0.5 ms", 0.5}, {"1 ms", 1.0}, {"2 ms", 2.0}, {"4 ms", 4.0}}) {
    setting.step_ms = step;
    if (done) done = add_row(table, label, go(setting), *reference);
  }
  if (go != run_smooth) {
    // The scale of the deviations: the same run started 20 ms later; the ball is kicked at the same time.
    setting.step_ms = 0.125;
    setting.lead_ms = 20;
    if (done) done = add_row(table, "0.125 ms, 20 ms later", go(setting), *reference);
  }
  const std::string written =
      text("\n%s, %s, gain %.0f\n\n", name.c_str(), setting.stepper.c_str(), setting.gain) +
      table.text();
  std::printf("%s", written.c_str());
  std::fflush(stdout);
  tables += written;
  return done;
}

Result<std::string> measure_all(const std::string& dynamics) {
  std::string tables;
  for (const auto& [name, load] : {std::pair{"stand", Load::stand}, {"walk", Load::walk}}) {
    for (const double gain : {20.0, 40.0, 80.0}) {
      Setting setting;
      setting.load = load;
      setting.stepper = dynamics;
      setting.gain = gain;
      auto done = measure(std::string(name) + " smooth", setting, run_smooth, tables);
      // At a gain of 40 the firmware's stall detection trips.
      if (done && gain == 20.0) done = measure(name, setting, run, tables);
      if (!done) return tl::unexpected(done.error());
    }
  }
  return tables;
}

}  // namespace
}  // namespace kaz::step_length

int main(int argc, char** argv) {
  using namespace kaz;
  CLI::App app("Deviation of the robot's motion by the length of the physics step, as tables.");
  std::string dynamics = "reduced", markdown;
  app.add_option("dynamics,--dynamics", dynamics, "reduced, exact or quickN")
      ->capture_default_str();
  studies::add_markdown_option(app, markdown);
  return studies::run_program(app, "step_length", argc, argv, [&]() -> Result<void> {
    const auto tables = KAZ_TRY(step_length::measure_all(dynamics));
    return studies::write_markdown(markdown, studies::command_line(argc, argv),
                                   "deterministic: 1 seed", tables);
  });
}
