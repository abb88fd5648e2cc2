// `kaz calibrate stereo`: two cameras from pictures of a chessboard.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/calibrate_stereo.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "shared/picture/png.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/provenance.h"
#include "tools/drawing/coverage.h"
#include "tools/vision/picture_pairs.h"
#include "vision/calibration/calibration_file.h"
#include "vision/calibration/camera_info.h"
#include "vision/image/picture_file.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;
using vision::Board;
using vision::StereoResult;

// Beyond these something was given wrongly, and the file would be a calibration of nothing.
constexpr const char* kSoftware = "kaz calibrate stereo";
constexpr double kMinSquare_m = 0.001, kMaxSquare_m = 0.5;
constexpr double kMinBaseline_m = 0.005, kMaxBaseline_m = 1;
constexpr double kMinFocal = 0.2,
                 kMaxFocal = 10;  // of the picture's width: views of 136 to 6 degrees

// What was seen of the board, picture by picture.
struct Sighting {
  PicturePair files;
  std::string left_error, right_error;  // empty: the board was found
};
struct Sightings {
  std::vector<Sighting> pairs;
  std::vector<vision::BoardPair> boards;
  int width = 0, height = 0;
};

// One picture of a pair.
struct Look {
  vision::Image image;
  vision::Corners corners;
};

// Empty corners: no board, `error` says why. An error: the pictures cannot be of one pair of cameras.
Result<Look> look(const std::string& path, const Board& board, Sightings& all, std::string& error) {
  auto image = vision::read_picture(path);
  if (!image) {
    error = image.error().message.substr(path.size() + 2);
    return Look{};
  }
  if (all.width == 0) {
    all.width = image->width;
    all.height = image->height;
  }
  if (image->width != all.width || image->height != all.height)
    return fail(Fault::usage, "'" + path + "' has " + std::to_string(image->width) + " x " +
                                  std::to_string(image->height) +
                                  " pixels, but the pictures before it have " +
                                  std::to_string(all.width) + " x " + std::to_string(all.height) +
                                  ": use pictures of equal size");
  vision::Corners corners = vision::find_board(*image, board);
  if (corners.empty()) error = "the whole board is not visible";
  return Look{std::move(*image), std::move(corners)};
}

// Copies of a picture would make lenses look better known than they are; of two that were taken, noise
// moves the corners.
Result<void> check_new(const vision::Corners& corners, const std::string& path,
                       const vision::Corners& before, const std::string& path_before) {
  if (corners.empty() || corners != before) return {};
  return fail(Fault::usage,
              "'" + path_before + "' and '" + path +
                  "' show the board at exactly the same place: give each picture once");
}

// Rejects a grid that is smaller than the board's. `seen`: size of the board in the picture before.
Result<void> check_whole(const vision::Image& image, const std::string& path, const Board& board,
                         std::optional<Board>& seen) {
  const Board whole = vision::largest_board(image, board);
  const bool again = seen && seen->columns == whole.columns && seen->rows == whole.rows;
  seen = whole;
  if (!again || (whole.columns == board.columns && whole.rows == board.rows)) return {};
  const auto text = [](const Board& of) {
    return std::to_string(of.columns) + "x" + std::to_string(of.rows);
  };
  return fail(
      Fault::usage,
      "'" + path + "' and the picture before it show a board of " + text(whole) +
          " inner corners. --board " + text(board) +
          " is smaller, so each eye could find a different part of the board: give --board " +
          text(whole));
}

Result<Sightings> look_at_all(const std::vector<PicturePair>& pairs, const Board& board,
                              bool quiet) {
  Sightings all;
  Progress progress("kaz calibrate", quiet);
  constexpr int kSearchedForMore =
      3;  // pictures; each such search takes as long as the one for the board
  int searched = 0;
  std::optional<Board> seen;
  for (const PicturePair& files : pairs) {
    progress.update(
        static_cast<double>(all.pairs.size()) / static_cast<double>(pairs.size()),
        "looking for the board in " + std::filesystem::path(files.left).filename().string());
    Sighting sighting{files, {}, {}};
    const auto left = KAZ_TRY(look(files.left, board, all, sighting.left_error));
    const auto right = KAZ_TRY(look(files.right, board, all, sighting.right_error));
    if (!left.corners.empty() && left.image.rgb == right.image.rgb)
      return fail(Fault::usage,
                  "'" + files.left + "' and '" + files.right +
                      "' are the same picture: give --left and --right pictures of two eyes");
    if (!left.corners.empty() && searched++ < kSearchedForMore)
      KAZ_TRY(check_whole(left.image, files.left, board, seen));
    for (std::size_t i = 0; i < all.pairs.size(); ++i) {
      const PicturePair& before = all.pairs[i].files;
      KAZ_TRY(check_new(left.corners, files.left, all.boards[i].left, before.left));
      KAZ_TRY(check_new(right.corners, files.right, all.boards[i].right, before.right));
    }
    all.pairs.push_back(sighting);
    all.boards.push_back({left.corners, right.corners});
  }
  progress.update(1, "fitting lenses and the transform between the eyes");
  return all;
}

double turn_rad(const StereoResult& result) {
  return Eigen::AngleAxisd(result.calibration.right_from_left()).angle();
}

Json eye_json(const vision::EyeQuality& eye, const vision::Lens& lens) {
  return {{"pictures", eye.pictures},
          {"rms_px", eye.rms_px},
          {"fx_px", lens.fx},
          {"fy_px", lens.fy},
          {"cx_px", lens.cx},
          {"cy_px", lens.cy},
          {"distortion", lens.distortion},
          {"fx_sigma_px", eye.focal_sigma_px},
          {"covered", eye.covered}};
}

Json as_json(const Sightings& seen, const StereoResult& result,
             const StereoCalibrationOptions& arguments) {
  const auto& c = result.calibration;
  Json pictures = Json::array();
  for (std::size_t i = 0; i < seen.pairs.size(); ++i) {
    const Sighting& s = seen.pairs[i];
    const vision::PairQuality& q = result.pairs[i];
    Json one{{"left", s.files.left}, {"right", s.files.right}, {"used", q.used}};
    if (!s.left_error.empty()) one["left_error"] = s.left_error;
    if (!s.right_error.empty()) one["right_error"] = s.right_error;
    if (q.used) {
      one["left_rms_px"] = q.left_rms_px;
      one["right_rms_px"] = q.right_rms_px;
      one["row_rms_px"] = q.row_rms_px;
    }
    pictures.push_back(one);
  }
  return {{"width", c.width},
          {"height", c.height},
          {"pairs", seen.pairs.size()},
          {"pairs_used", result.pairs_used},
          {"rms_px", result.rms_px},
          {"row_rms_px", result.row_rms_px},
          {"baseline_m", c.rectified.baseline_m},
          {"turn_rad", turn_rad(result)},
          {"left", eye_json(result.left, c.left.lens)},
          {"right", eye_json(result.right, c.right.lens)},
          {"pictures", pictures},
          {"calibration", arguments.out},
          {"coverage", arguments.coverage},
          {"provenance", provenance_json()}};
}

void print_eye(const char* side, const vision::EyeQuality& eye, const vision::Lens& lens) {
  print_lines(
      "%-5s  %d pictures, reprojection %.3f px rms; focal length %.2f px +- %.2f, center %.1f, "
      "%.1f; board in %.0f %% of the picture\n",
      side, eye.pictures, eye.rms_px, lens.fx, eye.focal_sigma_px, lens.cx, lens.cy,
      100 * eye.covered);
  if (eye.focal_sigma_px > 0.01 * lens.fx)
    std::printf(
        "       the focal length is uncertain by more than 1 %%: add pictures of a tilted board\n");
}

void print(const Sightings& seen, const StereoResult& result,
           const StereoCalibrationOptions& arguments) {
  const auto name = [](const std::string& path) {
    return std::filesystem::path(path).filename().string();
  };
  std::printf("%-24s %9s %9s %9s   px rms\n", "pair", "left", "right", "rows");
  for (std::size_t i = 0; i < seen.pairs.size(); ++i) {
    const Sighting& s = seen.pairs[i];
    const vision::PairQuality& q = result.pairs[i];
    const std::string both = name(s.files.left) + " " + name(s.files.right);
    if (q.used) {
      std::printf("%-24s %9.3f %9.3f %9.3f\n", both.c_str(), q.left_rms_px, q.right_rms_px,
                  q.row_rms_px);
      continue;
    }
    const bool left = !s.left_error.empty();
    print_lines("%-24s left out: %s: %s\n", both.c_str(),
                name(left ? s.files.left : s.files.right).c_str(),
                (left ? s.left_error : s.right_error).c_str());
  }
  print_eye("left", result.left, result.calibration.left.lens);
  print_eye("right", result.right, result.calibration.right.lens);
  print_lines(
      "both   %d of %zu pairs used; reprojection error %.3f px rms, row difference after "
      "rectification %.3f px rms\n       right eye %.5f m from the left eye, turned by %.4f rad\n",
      result.pairs_used, seen.pairs.size(), result.rms_px, result.row_rms_px,
      result.calibration.rectified.baseline_m, turn_rad(result));
  std::printf("written: %s, %s\n", arguments.out.c_str(), arguments.coverage.c_str());
}

// The files, opened before any picture is read.
struct Outputs {
  std::vector<OutputFile> calibration;  // two files for ROS, else one
  OutputFile coverage;
};

Result<std::vector<OutputFile>> open_calibration(const std::string& out) {
  std::vector<OutputFile> files;
  const auto pair = vision::camera_info_paths(out);
  const std::vector<std::string> paths =
      pair ? std::vector{pair->left, pair->right} : std::vector{out};
  for (const std::string& path : paths) files.push_back(KAZ_TRY(OutputFile::open(path, "--out")));
  return files;
}

Result<void> write(const StereoResult& result, const Board& board,
                   const StereoCalibrationOptions& arguments, Outputs& outputs) {
  const auto format = KAZ_TRY(vision::calibration_format(arguments.out));
  const auto& c = result.calibration;
  const figure::Panel panels[] = {
      {figure::coverage_picture(result.left, c.width, c.height),
       "left: corners, residuals enlarged 40 times"},
      {figure::coverage_picture(result.right, c.width, c.height), "right"}};
  const figure::Image both = figure::compose(panels, 2, 360);
  const auto png = KAZ_TRY(picture::encode_png(
      {.width = both.width, .height = both.height, .samples = both.rgb}, {.software = kSoftware}));
  KAZ_TRY(outputs.coverage.write({reinterpret_cast<const char*>(png.data()), png.size()}));
  if (format == vision::CalibrationFormat::camera_info) {
    const auto text = vision::camera_info_text(c);
    KAZ_TRY(outputs.calibration[0].write(text.left));
    return outputs.calibration[1].write(text.right);
  }
  const std::string text = vision::calibration_text(c, format,
                                                    {{"board_width", board.columns},
                                                     {"board_height", board.rows},
                                                     {"square_size", board.square_m},
                                                     {"pairs_used", result.pairs_used},
                                                     {"rms_left_px", result.left.rms_px},
                                                     {"rms_right_px", result.right.rms_px},
                                                     {"rms_stereo_px", result.rms_px},
                                                     {"rms_rows_px", result.row_rms_px}},
                                                    provenance().date);
  return outputs.calibration[0].write(text);
}

tl::unexpected<Error> too_far_off(const Sightings& seen, const StereoResult& result,
                                  const StereoCalibrationOptions& arguments) {
  std::size_t worst = 0;
  const auto off = [&](std::size_t i) {
    return std::hypot(result.pairs[i].left_rms_px, result.pairs[i].right_rms_px);
  };
  for (std::size_t i = 1; i < seen.pairs.size(); ++i) {
    if (off(i) > off(worst)) worst = i;
  }
  char numbers[96];
  std::snprintf(numbers, sizeof numbers,
                "error of the fit %.2f px rms: must be at most %.2f (--max-rms)", result.rms_px,
                arguments.max_rms_px);
  return fail(Fault::failed,
              std::string(numbers) + "; the error is largest in '" + seen.pairs[worst].files.left +
                  "': both pictures must be sharp and simultaneous, and must show this board");
}

// A fit that settles can still be of no two eyes.
Result<void> check_plausible(const StereoResult& result,
                             const StereoCalibrationOptions& arguments) {
  char text[200];
  const auto& c = result.calibration;
  for (const auto& [side, lens] :
       {std::pair("left", c.left.lens), std::pair("right", c.right.lens)}) {
    for (const double focal_px : {lens.fx, lens.fy}) {
      if (focal_px >= kMinFocal * c.width && focal_px <= kMaxFocal * c.width) continue;
      std::snprintf(text, sizeof text,
                    "the fitted focal length of the %s eye, %.0f px in pictures %d px wide, is not "
                    "plausible; take pictures with the board tilted in different ways",
                    side, focal_px, c.width);
      return fail(Fault::failed, text);
    }
  }
  const double baseline_m = c.rectified.baseline_m;
  if (baseline_m >= kMinBaseline_m && baseline_m <= kMaxBaseline_m) return {};
  std::snprintf(
      text, sizeof text,
      "the fitted distance of the eyes, %.4f m, must be %.3f to %.0f m: check that --left and "
      "--right are from two eyes, and that a square is %g m long (--square)",
      baseline_m, kMinBaseline_m, kMaxBaseline_m, arguments.square_m);
  return fail(Fault::failed, text);
}

}  // namespace

Result<Board> parse_board(const std::string& text, double square_m) {
  int columns = 0, rows = 0, end = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &columns, &rows, &end) != 2 ||
      end != static_cast<int>(text.size()) || columns < 3 || rows < 3 || columns > 100 ||
      rows > 100)
    return fail(
        Fault::usage,
        "--board '" + text +
            "': give the number of inner corners along each side, 3 to 100, for example 9x6 for "
            "a board of 10 x 7 squares");
  if (square_m < kMinSquare_m || square_m > kMaxSquare_m) {
    char wrong[120];
    std::snprintf(wrong, sizeof wrong,
                  "--square %g: must be 0.001 to 0.5 m; for example, 25 mm is 0.025", square_m);
    return fail(Fault::usage, wrong);
  }
  return Board{columns, rows, square_m};
}

Result<bool> calibrate_stereo(StereoCalibrationOptions arguments) {
  const auto board = KAZ_TRY(parse_board(arguments.board, arguments.square_m));
  KAZ_TRY(vision::calibration_format(arguments.out));
  if (arguments.coverage.empty()) {
    const auto pair = vision::camera_info_paths(arguments.out);
    arguments.coverage = std::filesystem::path(pair ? pair->left : arguments.out)
                             .replace_extension(".coverage.png")
                             .string();
  }
  const auto pairs = KAZ_TRY(find_pairs(arguments.left, arguments.right));
  for (const auto& pair : pairs) {
    for (const std::string& input : {pair.left, pair.right}) {
      std::error_code none;
      if (std::filesystem::equivalent(arguments.coverage, input, none))
        return fail(Fault::usage, "--coverage " + arguments.coverage +
                                      ": is a picture of the calibration; give another file");
    }
  }
  auto calibration = KAZ_TRY(open_calibration(arguments.out));
  auto coverage = KAZ_TRY(OutputFile::open(arguments.coverage, "--coverage"));
  Outputs outputs{std::move(calibration), std::move(coverage)};
  const auto seen = KAZ_TRY(look_at_all(pairs, board, arguments.json));
  const auto result = vision::calibrate_stereo(seen.boards, board, seen.width, seen.height);
  if (!result) {
    std::string why = result.error().message;
    for (const Sighting& s : seen.pairs) {
      if (s.left_error.empty() && s.right_error.empty()) continue;
      const bool left = !s.left_error.empty();
      why += "; first left out: '" + (left ? s.files.left : s.files.right) + "', " +
             (left ? s.left_error : s.right_error) + " (looked for " + arguments.board +
             " inner corners)";
      break;
    }
    return fail(result.error().fault, why);
  }
  if (result->rms_px > arguments.max_rms_px) return too_far_off(seen, *result, arguments);
  KAZ_TRY(check_plausible(*result, arguments));
  KAZ_TRY(write(*result, board, arguments, outputs));
  if (arguments.json) {
    print_json(as_json(seen, *result, arguments));
  } else {
    print(seen, *result, arguments);
  }
  return true;
}

}  // namespace kaz::tools
