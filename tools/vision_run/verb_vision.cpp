// `kaz vision`: colours learned from a picture, and vision on recorded pictures.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "shared/base/counted.hpp"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/provenance.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/drawing/figure.h"
#include "tools/run/live_camera.h"
#include "tools/vision/color_file.h"
#include "tools/vision/modules.h"
#include "tools/vision_run/recorded_pictures.h"
#include "vision/color/color_learning.h"
#include "vision/image/picture_file.h"

namespace kaz::tools {
namespace {

struct LearnArguments {
  std::vector<std::string> in, region;
  std::string out;
  bool json = false;
};

Result<vision::PictureRegion> parse_region(const std::string& text) {
  vision::PictureRegion r;
  int end = 0;
  if (text.size() < 40 &&
      std::sscanf(text.c_str(), "%9d,%9d,%9d,%9d%n", &r.x, &r.y, &r.width, &r.height, &end) == 4 &&
      end == static_cast<int>(text.size()))
    return r;
  return fail(Fault::usage, "--region " + text +
                                ": give left, top, width and height in px, such as 120,80,40,30");
}

Result<ExitStatus> learn(const LearnArguments& arguments) {
  if (arguments.in.size() != arguments.region.size())
    return fail(Fault::usage, "--in has " + counted(arguments.in.size(), "picture") +
                                  ", --region has " + counted(arguments.region.size(), "region") +
                                  ": give one region for each picture, in the same order");
  std::vector<vision::PictureRegion> regions;
  for (const std::string& text : arguments.region) {
    const auto region = KAZ_TRY(parse_region(text));
    regions.push_back(region);
  }
  auto out = KAZ_TRY(OutputFile::open(arguments.out, "--out"));
  std::vector<vision::MarkedPicture> pictures;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    auto image = KAZ_TRY(vision::read_picture(arguments.in[i]));
    pictures.push_back({arguments.in[i], std::move(image), regions[i]});
  }
  const auto learned = KAZ_TRY(vision::learn_color(pictures));
  nlohmann::ordered_json json = color_json(learned.range);
  json["share_of_region"] = learned.inside;
  json["share_of_rest"] = learned.outside;
  std::string warning;
  if (learned.too_common()) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "%.0f %% of the rest of the picture also has this color. If these pixels do not "
                  "show the object, mark only the object or take a picture with another background",
                  100 * learned.outside);
    warning = text;
    json["warning"] = warning;
  }
  json["provenance"] = provenance_json();
  const std::string text = json.dump(2) + "\n";
  KAZ_TRY(out.write(text));
  if (arguments.json) {
    std::printf("%s", text.c_str());
    return ExitStatus(true);
  }
  print_lines(
      "color: hue %.3f to %.3f rad, saturation at least %.2f, lightness at least %.0f; %.1f %% of "
      "the region and %.2f %% of the rest of the picture have this color\n"
      "written: %s\n",
      learned.range.hue_min, learned.range.hue_max, learned.range.saturation_min,
      learned.range.y_min, 100 * learned.inside, 100 * learned.outside, arguments.out.c_str());
  if (!warning.empty()) print_lines("warning: %s\n", warning.c_str());
  return ExitStatus(true);
}

void add_learn(CLI::App& vision, Action& action) {
  auto* verb = vision.add_subcommand(
      "learn-color", "learn the thresholds of a color from a marked region of a picture");
  auto arguments = std::make_shared<LearnArguments>();
  verb->add_option("--in", arguments->in,
                   "picture that shows the object. Repeat --in and --region for several pictures, "
                   "such as of other places or other light")
      ->required()
      ->type_name("PICTURE");
  verb->add_option("--region", arguments->region,
                   "part of the picture that shows only the object, px")
      ->required()
      ->type_name("X,Y,W,H");
  verb->add_option("--out", arguments->out, "JSON file for the thresholds")
      ->required()
      ->type_name("FILE");
  verb->add_flag("--json", arguments->json, "also print the thresholds as JSON");
  verb->footer(
      "Kaz counts the pixels outside the region that also have the learned color. Kaz prints their "
      "number as a percentage of all pixels outside the region. If the percentage is above 25 %, "
      "Kaz prints a warning, because only the object should have the color.\n"
      "Examples:\n"
      "  kaz eyes --world ball --eye-width 640 --out eyes\n"
      "  kaz vision learn-color --in eyes/left_raw.png --region 415,330,24,24 --out ball.json");
  verb->callback([&action, arguments] { action = [arguments] { return learn(*arguments); }; });
}

// Adds --in, --left and --right.
void add_sources(CLI::App& verb, RecordedOptions& options) {
  auto* in = verb.add_option("--in", options.in,
                             "source of the pictures: a folder, one picture, a recording "
                             "(recording.mcap, made with --record-pictures), a camera socket (kaz "
                             "sim --cameras), or two cameras of this machine "
                             "(v4l2:LEFT,RIGHT[,fps=N][,format=NAME], such as "
                             "v4l2:/dev/video0,/dev/video2). The pictures in a folder are used in "
                             "the order of their names. A recording may also be an MCAP file of "
                             "another program (--topics)")
                 ->type_name("SOURCE");
  auto* left = verb.add_option("--left", options.left,
                               "left pictures of stereo pairs: a file name pattern in quotes")
                   ->excludes(in)
                   ->type_name("PATTERN");
  auto* right =
      verb.add_option("--right", options.right,
                      "right pictures of the stereo pairs: a file name pattern in quotes. "
                      "The pictures of a pair have the same number in their names")
          ->needs(left)
          ->type_name("PATTERN");
  left->needs(right);
  verb.add_option("--topics", options.topics,
                  "for an MCAP file of another program: topics of the left and right pictures "
                  "(default: the only pair of topics named left and right). The calibration comes "
                  "from --calibration, or from the topics camera_info beside the pictures")
      ->needs(in)
      ->type_name("LEFT,RIGHT");
}

void add_run_on_pictures(CLI::App& vision, Action& action) {
  auto* verb = vision.add_subcommand(
      "run",
      "find balls, depth, planes and motion in pictures from files, recordings or live cameras");
  auto options = std::make_shared<RecordedOptions>();
  add_sources(*verb, *options);
  verb->add_option("--out", options->out, "folder for overlays, a table (CSV) and result.json")
      ->required()
      ->type_name("DIR");
  verb->add_option("--modules", options->modules,
                   "modules to run, separated by commas: " + module_names() +
                       "; the module 'color' finds the ball by its color, and the other modules "
                       "need stereo pairs")
      ->capture_default_str()
      ->type_name("LIST");
  verb->add_option("--color", options->color,
                   "file with the ball's color, written by kaz vision learn-color (default: red)")
      ->type_name("FILE");
  auto* calibration =
      verb->add_option("--calibration", options->calibration,
                       "calibration file of the cameras, written by kaz calibrate stereo or in "
                       "OpenCV's format, or LEFT.yaml,RIGHT.yaml of ROS (camera_info). Stereo "
                       "pairs (--left and --right) and v4l2 cameras need this file. One picture "
                       "or a folder of pictures is treated as pictures of the left eye. Without "
                       "this file and --view, Kaz finds balls in pixels, without distance")
          ->type_name("FILE");
  verb->add_option(
          "--view", options->view_deg,
          "for one picture or a folder of pictures, without --calibration: horizontal field of "
          "view of a pinhole camera, degrees")
      ->check(between(1.0, 170.0, "degrees"))
      ->excludes(calibration)
      ->type_name("DEGREES");
  verb->add_option("--radius", options->radius_m, "radius of the ball, m")
      ->check(between(0.005, 0.5, "m"))
      ->capture_default_str()
      ->type_name("M");
  verb->add_option("--nearest", options->nearest_m,
                   "smallest distance for which depth is computed, m. A larger value makes the "
                   "computation faster, because Kaz then searches fewer disparities. The number of "
                   "disparities is a multiple of 16. With Kaz's eyes, the largest valid value is "
                   "0.476 m, or 0.953 m for pictures 640 px wide")
      ->check(between(0.001, 100.0, "m"))
      ->default_str("0.14")
      ->type_name("M");
  verb->add_option("--export", options->exported,
                   "files to write for each frame: depth, points, or both (depth,points). "
                   "FRAME.depth.png contains the depth in mm as 16-bit values, and 0 where the "
                   "depth is unknown. FRAME.points.ply contains points in m, in the left eye's "
                   "optical frame")
      ->type_name("LIST");
  verb->add_option("--frames", options->frames,
                   "stop after N pairs of pictures, or after N single pictures")
      ->check(between(1, 100000000))
      ->type_name("N");
  verb->add_option("--robot", options->robot,
                   "for a live camera: the robot that carries the camera (a PORT, such as "
                   "serial:/dev/ttyUSB0); the robot's posture determines which plane is the floor")
      ->type_name("ROBOT");
  add_address(*verb, options->address)->needs("--robot");
  verb->add_flag(
      "--json", options->json,
      "print result.json, without progress messages; the files in --out are written too");
  verb->footer(
      "Exit status: 0 done, even if no ball was found; 1 none of the pictures could be processed; "
      "2 wrong usage, or no picture was found; 3 a camera or port failed, and earlier results are "
      "kept.\n"
      "Examples:\n"
      "  kaz vision run --in pictures --view 60 --out found\n"
      "  kaz vision run --in photographs --color ball.json --out found\n"
      "  kaz vision run --in left --calibration stereo.yml --color ball.json --radius 0.033 \\\n"
      "      --out found --json\n"
      "  kaz vision run --left 'eyes/left*.png' --right 'eyes/right*.png' \\\n"
      "      --calibration stereo.yml --modules color,depth,planes --out found\n"
      "  kaz vision run --left left01.jpg --right right01.jpg --calibration stereo.yml \\\n"
      "      --export depth,points --out cloud\n"
      "  kaz run search-ball --record-pictures --out seen\n"
      "  kaz vision run --in seen/recording.mcap --modules color,planes --out found\n"
      "  kaz vision run --in stereo.mcap --topics /left/image_raw,/right/image_raw --out found\n"
      "  kaz vision run --in robot.eyes --robot serial:robot.pty --modules planes --frames 90 \\\n"
      "      --out found\n"
      "  kaz vision run --in v4l2:/dev/video0,/dev/video2 --calibration stereo.yml \\\n"
      "      --modules color,depth --frames 90 --out found");
  verb->callback([&action, options] {
    action = [options]() -> Result<bool> {
      if (!options->left.empty()) return run_on_pairs(*options);
      if (!options->in.empty()) return run_on_source(*options);
      return fail(Fault::usage, "pictures are missing; give --in SOURCE, or --left and --right");
    };
  });
}

}  // namespace

void add_vision(CLI::App& program, Action& action) {
  auto* verb =
      program.add_subcommand("vision", "process pictures from files, recordings or live cameras");
  verb->require_subcommand(1);
  verb->footer(
      "Examples:\n"
      "  kaz eyes --world ball --eye-width 640 --out eyes\n"
      "  kaz vision learn-color --in eyes/left_raw.png --region 415,330,24,24 --out ball.json\n"
      "  kaz vision run --in pictures --view 60 --color ball.json --out found");
  add_run_on_pictures(*verb, action);
  add_learn(*verb, action);
}

}  // namespace kaz::tools
