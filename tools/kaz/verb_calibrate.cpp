// `kaz calibrate stereo`: two cameras from pictures of a chessboard.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/app/vision/calibrate_stereo.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {

void add_calibrate(CLI::App& program, Action& action) {
  auto* verb =
      program.add_subcommand("calibrate", "calibrate cameras from pictures of a chessboard");
  verb->require_subcommand(1);
  verb->footer(
      "Examples:\n"
      "  kaz calibrate stereo --left 'eyes/left*.png' --right 'eyes/right*.png' \\\n"
      "      --board 9x6 --square 0.025 --out stereo.yml");
  auto* stereo = verb->add_subcommand(
      "stereo", "lenses and relative position of two cameras, from pictures of a chessboard");
  auto arguments = std::make_shared<StereoCalibrationOptions>();
  stereo->add_option("--left", arguments->left, "pictures of the left eye; a pattern in quotes")
      ->required()
      ->type_name("PATTERN");
  stereo
      ->add_option("--right", arguments->right,
                   "pictures of the right eye, taken at the same times")
      ->required()
      ->type_name("PATTERN");
  stereo
      ->add_option("--board", arguments->board,
                   "inner corners of the board, 3 to 100 along each side: 10 x 7 squares have "
                   "9x6")
      ->required()
      ->type_name("COLUMNSxROWS");
  stereo
      ->add_option("--square", arguments->square_m,
                   "side of a square, 0.001 to 0.5 m: 25 mm are 0.025")
      ->required()
      ->check(positive())
      ->type_name("M");
  stereo->add_option("--out", arguments->out, "calibration file: .yml or .json of OpenCV's kind")
      ->required()
      ->type_name("FILE");
  stereo
      ->add_option("--coverage", arguments->coverage,
                   "picture of where the board was seen; without it beside FILE, "
                   "FILE.coverage.png")
      ->type_name("PNG");
  stereo
      ->add_option("--max-rms", arguments->max_rms_px,
                   "reprojection error in px above which nothing is written")
      ->check(between(0.01, 5.0))
      ->capture_default_str()
      ->type_name("PX");
  stereo->add_flag("--json", arguments->json, "print the report as JSON, no progress");
  stereo->footer(
      "A pair is two pictures with the same last number in their names (left07.jpg, right07.jpg). "
      "Pictures without the whole board are named and left out; " +
      std::to_string(vision::kLeastPairs) +
      " pairs have to remain. "
      "Move and tilt the board until the coverage picture is full, corners too.\n"
      "Exit status: 0 done, 1 no good calibration comes of them, 2 wrong usage.\n"
      "Examples:\n"
      "  kaz calibrate stereo --left 'eyes/left*.png' --right 'eyes/right*.png' \\\n"
      "      --board 9x6 --square 0.025 --out stereo.yml\n"
      "  kaz calibrate stereo --left 'l*.jpg' --right 'r*.jpg' --board 7x5 --square 0.03 \\\n"
      "      --out stereo.json --json");
  stereo->callback(
      [&action, arguments] { action = [arguments] { return calibrate_stereo(*arguments); }; });
}

}  // namespace kaz::tools
