// docs/pictures/figure7.png: the maps by slow vision while the head turns, and the errors of their edges.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <CLI/CLI.hpp>

#include "tests/studies/common/program.h"
#include "tests/studies/common/table.h"
#include "tests/studies/figure7/panels.h"
#include "tools/figure/figure.h"

int main(int argc, char** argv) {
  using namespace kaz;
  using studies::text;
  CLI::App app("A local map by slow vision of a turning head, with and without frame information.");
  figure7::Options options{KAZ_YARD, KAZ_ROBOT, KAZ_FIRMWARE_IMAGE};
  std::string picture, markdown;
  app.add_option("file", picture, "PNG file of both maps")->required();
  app.add_option("width", options.eye_width, "width of the eyes' pictures, px")
      ->check(CLI::IsMember({320, 640}));
  app.add_option("world", options.world, "SDF file of boxes on a floor");
  studies::add_markdown_option(app, markdown);
  return studies::run_program(app, "figure7_picture", argc, argv, [&]() -> Result<void> {
    const auto run = KAZ_TRY(figure7::sweep(options));
    if (auto done = figure::write_png(picture, figure7::panels(run)); !done) return done;
    studies::MarkdownTable table({"frame information", "pictures", "places on edges",
                                  "error mean, mm", "median", "95 %", "max"});
    for (const auto* map : {&run.with, &run.without}) {
      const auto s = figure7::score(figure7::edge_errors(*map, run.edges, 0.2, 0.8));
      table.add({map == &run.with ? "with" : "without", std::to_string(run.pictures),
                 std::to_string(s.points), text("%+.1f", 1e3 * s.mean_m),
                 text("%.1f", 1e3 * s.median_m), text("%.1f", 1e3 * s.p95_m),
                 text("%.1f", 1e3 * s.max_m)});
    }
    std::printf("%s", table.text().c_str());
    return studies::write_markdown(markdown, studies::command_line(argc, argv), "1 seed",
                                   table.text());
  });
}
