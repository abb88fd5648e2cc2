// map_table: kinds of floor and of thing in the simulated eyes' pictures, and what the map makes of them.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <CLI/CLI.hpp>

#include "tests/studies/common/program.h"
#include "tests/studies/map_table/table.h"

int main(int argc, char** argv) {
  using namespace kaz;
  CLI::App program{
      "A robot walks towards things on floors, and maps them: of the things those that would have "
      "stopped it "
      "before it reached them, of the floor what the map takes for obstacles, as a Markdown "
      "table.\n"
      "  map_table --out out/map    table.md and table.json there"};
  bool json = false;
  std::string out, only, markdown, renderer = to_string(sim::kDefaultRenderer);
  int approaches = 20;
  std::uint64_t seed = 1;
  program.add_flag("--json", json, "print JSON instead of the table");
  program.add_option("--out", out, "also write the table into this folder");
  program.add_option("--only", only, "rows whose name, FLOOR THING, contains this");
  program.add_option("--approaches", approaches, "of each row")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  program.add_option("--seed", seed, "of a row's first approach")->capture_default_str();
  program.add_option("--renderer", renderer, "what draws the pictures: opengl or raster")
      ->check(CLI::IsMember({"opengl", "raster"}))
      ->capture_default_str();
  studies::add_markdown_option(program, markdown);
  return studies::run_program(program, "map_table", argc, argv, [&]() -> Result<void> {
    auto kind = sim::kDefaultRenderer;
    for (const sim::RendererKind one : sim::kRendererKinds) {
      if (renderer == to_string(one)) kind = one;
    }
    const auto rows = KAZ_TRY(map_table::measure(only, approaches, seed, kind));
    const std::string table = map_table::markdown(rows), data = map_table::json(rows);
    std::printf("%s", (json ? data : table).c_str());
    if (!out.empty()) KAZ_TRY(studies::write_tables(out, "table", table, data));
    return studies::write_markdown(markdown, studies::command_line(argc, argv),
                                   std::to_string(approaches) + " approaches a row", table);
  });
}
