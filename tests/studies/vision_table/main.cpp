// Prints what vision finds in the simulated eyes' pictures, beside the truth.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>

#include <CLI/CLI.hpp>

#include "tests/studies/vision_table/pictures.h"
#include "tools/figure/figure.h"

namespace {

using namespace kaz;
using namespace kaz::vision_table;

Result<void> measure(const std::string& only, int pictures, int robust, Table& table) {
  const auto all = [&](const char* part) { return only.empty() || only == part; };
  if (all("accuracy")) {
    for (const int width : {320, 640}) {
      for (const Sight sight : {Sight::whole, Sight::cut, Sight::hidden}) {
        std::fprintf(stderr, "vision_table: ball, %d px\n", width);
        if (auto done = measure_accuracy(width, sight, pictures, table); !done) return done;
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
    // Debian's opencv-doc; left out where it is not installed.
    if (std::filesystem::exists(std::string(KAZ_PHOTOGRAPHS) + "/left01.jpg"))
      return measure_boards(KAZ_PHOTOGRAPHS, table);
  }
  return {};
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
  // Of the rows of whole balls.
  return table.accuracy.empty() ? Result<void>{}
                                : write_picture(folder + "/vision_table.png", table);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{
      "What vision finds in pictures of the simulated eyes, beside the truth, as Markdown tables. "
      "Takes half an hour; --pictures 20 --robust-pictures 9 some minutes.\n"
      "  vision_table --out out/vision    table.md, table.json and pictures there"};
  bool json = false;
  std::string out, only;
  int pictures = 250, robust = 90;
  program.add_flag("--json", json, "print JSON instead of the tables");
  program.add_option("--out", out, "also write tables and pictures into this folder");
  program.add_option("--only", only, "accuracy, boards, or a row or group of the robustness table");
  program.add_option("--pictures", pictures, "pictures for each row of the accuracy tables")
      ->check(CLI::Range(1, 100000));
  program
      .add_option("--robust-pictures", robust,
                  "pictures for each row of the robustness tables; a third is without a ball")
      ->check(CLI::Range(3, 100000));
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : static_cast<int>(Fault::usage);
  }
  Table table;
  auto done = measure(only, pictures, robust, table);
  if (done) std::printf("%s", (json ? table.json() : table.markdown()).c_str());
  if (done && !out.empty()) done = write(out, table);
  if (done) return 0;
  std::fprintf(stderr, "vision_table: %s\n", done.error().message.c_str());
  return static_cast<int>(done.error().fault);
}
