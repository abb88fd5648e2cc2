// dynamics_table: errors of the dynamics against closed forms, and a plot of the energy error over the step.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "tests/studies/common/program.h"
#include "tests/studies/dynamics_table/table.h"
#include "tools/drawing/figure.h"

namespace {

using namespace kaz;
using namespace kaz::dynamics_table;

figure::PlotPage page_of(const Table& table) {
  using Style = figure::Series::Style;
  figure::PlotPage page;
  page.title = "Energy of pendulums, max error in 10 s";
  page.x_label = "log10 of the step in ms";
  page.width_px = 720;
  page.plot_height_px = 280;
  const figure::Color colors[] = {figure::kBlue, figure::kRed, figure::kOrange};
  for (const auto& [pendulum, steppers] : table.energies) {
    figure::LinePlot plot;
    plot.title = pendulum;
    plot.y_label = "log10 of the relative error";
    std::vector<double> x;
    for (const double ms : kStepsMs) x.push_back(std::log10(ms));
    std::size_t number = 0;
    for (const char* stepper : kSteppers) {
      std::vector<double> y;
      for (const double error : steppers.at(stepper)) y.push_back(std::log10(error));
      plot.series.push_back(
          {stepper, colors[number], x, y, 2.0, number == 2 ? Style::dashed : Style::line});
      ++number;
    }
    // A line of slope 1 through the required 1e-3 at 1 ms.
    std::vector<double> line;
    for (const double v : x) line.push_back(v - 3);
    plot.series.push_back({"proportional to the step", figure::kGrey, x, line, 1.4, Style::dashed});
    page.plots.push_back(plot);
  }
  return page;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{
      "Errors of each implementation of the dynamics against closed-form solutions, as Markdown "
      "tables. Takes a minute or two.\n"
      "  dynamics_table --out out/dynamics    table.md, table.json and pendulums.png there"};
  bool json = false;
  std::string out, markdown;
  program.add_flag("--json", json, "print JSON instead of the table");
  program.add_option("--out", out, "also write tables and plot into this folder");
  studies::add_markdown_option(program, markdown);
  return studies::run_program(program, "dynamics_table", argc, argv, [&]() -> Result<void> {
    Table table;
    for (const std::string dynamics : kSteppers) {
      std::fprintf(stderr, "dynamics_table: %s\n", dynamics.c_str());
      run_all(dynamics, table);
      swing_by_step(dynamics, table);
    }
    std::printf("%s", (json ? table.json() : table.markdown()).c_str());
    if (!out.empty()) {
      auto done = studies::write_tables(out, "table", table.markdown(), table.json());
      if (done) done = figure::write_plot_png(out + "/pendulums.png", page_of(table));
      if (!done) return done;
    }
    return studies::write_markdown(markdown, studies::command_line(argc, argv),
                                   "deterministic: no seeds", table.markdown());
  });
}
