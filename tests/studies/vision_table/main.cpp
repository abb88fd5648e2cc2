// vision_table: accuracy of vision on images of the simulated eyes, against ground truth.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>

#include <CLI/CLI.hpp>

#include "tests/studies/common/program.h"
#include "tests/studies/vision_table/plots.h"

namespace {

using namespace kaz;
using namespace kaz::vision_table;

Result<void> measure(const std::string& only, int pictures, int robust, Table& table) {
  const auto all = [&](const char* part) { return only.empty() || only == part; };
  if (all("accuracy")) {
    for (const int width : {320, 640}) {
      for (const Visibility visibility : {Visibility::whole, Visibility::cut, Visibility::hidden}) {
        std::fprintf(stderr, "vision_table: ball, %d px\n", width);
        if (auto done = measure_accuracy(width, visibility, pictures, table); !done) return done;
      }
    }
  }
  if (only != "accuracy" && only != "boards") {
    for (const int width : {320, 640}) {
      std::fprintf(stderr, "vision_table: robustness, %d px\n", width);
      if (auto done = measure_robustness(width, robust, only, table); !done) return done;
    }
  }
  if (all("boards")) {
    std::fprintf(stderr, "vision_table: photographed chessboards\n");
    // From Debian's opencv-doc; skipped if it is not installed.
    if (std::filesystem::exists(std::string(KAZ_PHOTOGRAPHS) + "/left01.jpg"))
      return measure_boards(KAZ_PHOTOGRAPHS, table);
  }
  return {};
}

Result<void> write(const std::string& folder, const Table& table) {
  if (auto done = studies::write_tables(folder, "table", table.markdown(), table.json()); !done)
    return done;
  // From the rows of whole balls.
  return table.accuracy.empty() ? Result<void>{} : write_plot(folder + "/vision_table.png", table);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{
      "Accuracy of vision on pictures of the simulated eyes against ground truth, as Markdown "
      "tables. "
      "Takes half an hour; --pictures 20 --robust-pictures 9 some minutes.\n"
      "  vision_table --out out/vision    table.md, table.json and pictures there"};
  bool json = false;
  std::string out, only, markdown, renderer = to_string(sim::kDefaultRenderer);
  int pictures = 250, robust = 90;
  program.add_flag("--json", json, "print JSON instead of the tables");
  program.add_option("--out", out, "also write tables and pictures into this folder");
  program.add_option("--only", only, "accuracy, boards, or a row or group of the robustness table");
  program.add_option("--pictures", pictures, "pictures for each row of the accuracy tables")
      ->check(CLI::Range(1, 100000));
  program
      .add_option("--robust-pictures", robust,
                  "pictures for each row of the robustness tables; a third of them without a ball")
      ->check(CLI::Range(3, 100000));
  program.add_option("--renderer", renderer, "what draws the pictures: opengl or raster")
      ->check(CLI::IsMember({"opengl", "raster"}))
      ->capture_default_str();
  studies::add_markdown_option(program, markdown);
  return studies::run_program(program, "vision_table", argc, argv, [&]() -> Result<void> {
    Table table;
    for (const sim::RendererKind kind : sim::kRendererKinds) {
      if (renderer == to_string(kind)) table.renderer = kind;
    }
    if (auto done = measure(only, pictures, robust, table); !done) return done;
    std::printf("%s", (json ? table.json() : table.markdown()).c_str());
    if (!out.empty()) {
      if (auto done = write(out, table); !done) return done;
    }
    return studies::write_markdown(markdown, studies::command_line(argc, argv),
                                   "1 seed, " + std::to_string(pictures) + " and " +
                                       std::to_string(robust) + " pictures a row",
                                   table.markdown());
  });
}
