// Prints how far each stepper is from closed forms, and draws the error of energy over the step.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <CLI/CLI.hpp>

#include "tests/studies/dynamics_table/table.h"
#include "tools/figure/figure.h"

namespace {

using namespace kaz;
using namespace kaz::dynamics_table;

figure::PlotPage page_of(const Table& table) {
  figure::PlotPage page;
  page.title = "Energy of pendulums, largest error in 10 s";
  page.x_label = "log10 of the step in ms";
  page.width_px = 720;
  page.plot_height_px = 280;
  const figure::Color colors[] = {figure::kBlue, figure::kRed, figure::kOrange};
  for (const auto& [pendulum, steppers] : table.energies) {
    figure::LinePlot plot;
    plot.title = pendulum;
    plot.y_label = "log10 of the share";
    std::vector<double> x;
    for (const double ms : kStepsMs) x.push_back(std::log10(ms));
    std::size_t number = 0;
    for (const char* stepper : kSteppers) {
      std::vector<double> y;
      for (const double error : steppers.at(stepper)) y.push_back(std::log10(error));
      plot.series.push_back({stepper, colors[number], x, y, 2.0, number == 2});
      ++number;
    }
    // As a line of slope 1 through what is asked for: 1e-3 at 1 ms.
    std::vector<double> line;
    for (const double v : x) line.push_back(v - 3);
    plot.series.push_back({"in proportion to the step", figure::kGrey, x, line, 1.4, true});
    page.plots.push_back(plot);
  }
  return page;
}

Result<void> write(const std::string& folder, const Table& table) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Fault::environment, folder + ": cannot be made: " + error.message());
  const auto text = [&](const std::string& name, const std::string& all) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(all.data());
    return figure::write_file(folder + "/" + name, {bytes, all.size()});
  };
  if (auto done = text("table.md", table.markdown()); !done) return done;
  if (auto done = text("table.json", table.json()); !done) return done;
  return figure::write_plot_png(folder + "/pendulums.png", page_of(table));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{
      "How far each stepper of the dynamics is from closed-form answers, as a Markdown table. "
      "Takes a "
      "minute or two.\n"
      "  dynamics_table --out out/dynamics    table.md, table.json and pendulums.png there"};
  bool json = false;
  std::string out;
  program.add_flag("--json", json, "print JSON instead of the table");
  program.add_option("--out", out, "also write table and picture into this folder");
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : static_cast<int>(Fault::usage);
  }
  Table table;
  for (const std::string stepper : kSteppers) {
    std::fprintf(stderr, "dynamics_table: %s\n", stepper.c_str());
    run_all(stepper, table);
    swing_by_step(stepper, table);
  }
  std::printf("%s", (json ? table.json() : table.markdown()).c_str());
  if (out.empty()) return 0;
  if (const auto done = write(out, table); !done) {
    std::fprintf(stderr, "dynamics_table: %s\n", done.error().message.c_str());
    return static_cast<int>(done.error().fault);
  }
  return 0;
}
