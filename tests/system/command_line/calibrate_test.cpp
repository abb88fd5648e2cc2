// `kaz calibrate stereo` on real photographs: the chessboard pairs that come with OpenCV.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"
#include "vision/calibration/calibration_file.h"
#include "vision/calibration/rectify.h"
#include "vision/calibration/stereo_calibration.h"
#include "vision/image/picture_file.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kPictures = KAZ_OPENCV_PICTURES;

Finished calibrate(const std::string& folder, const std::string& out,
                   const std::vector<std::string>& more = {}, const std::string& board = "9x6") {
  std::vector<std::string> arguments{"calibrate", "stereo",
                                     "--left",    folder + "/left[0-9]*.jpg",
                                     "--right",   folder + "/right[0-9]*.jpg",
                                     "--board",   board,
                                     "--square",  "0.025",
                                     "--out",     out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(kaz(arguments));
}

// Some of the pairs in a folder of their own, to be spoilt.
void copy_pairs(const std::string& to, const std::vector<std::string>& numbers) {
  for (const auto& number : numbers) {
    for (const std::string side : {"left", "right"})
      fs::copy_file(kPictures + "/" + side + number + ".jpg", to + "/" + side + number + ".jpg");
  }
}

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "";
  const auto begin = text.rfind('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - (begin + 1) + 1);
}

// The exit code, one last sentence with all words in it, no calibration written.
void expect_refusal(const Finished& finished, int exit_code, const std::string& out,
                    const std::vector<std::string>& words) {
  EXPECT_EQ(finished.exit_code, exit_code) << finished.err;
  const std::string said = last_line(finished.err);
  EXPECT_EQ(said.rfind("kaz calibrate stereo: ", 0), 0u) << finished.err;
  for (const auto& word : words)
    EXPECT_NE(said.find(word), std::string::npos) << word << ": " << said;
  EXPECT_FALSE(fs::exists(out));
}

// The part of a larger board may be another one for each eye.
TEST(Calibrate, APartOfTheBoardIsRefused) {
  const TemporaryFolder folder;
  const std::string out = folder / "part.yml";
  expect_refusal(calibrate(kPictures, out, {}, "8x6"), 2, out, {"9x6 inner corners", "8x6"});
}

TEST(Calibrate, PhotographsOfAChessboardToUnderHalfAPixel) {
  const TemporaryFolder folder;
  const std::string out = folder / "stereo.yml";
  const Finished finished = calibrate(kPictures, out, {"--json"});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_TRUE(finished.err.empty()) << finished.err;
  const json report = parse_json(finished.out);
  std::printf("pairs %d of %d; reprojection px rms: left %.3f, right %.3f, both %.3f; rows %.3f\n",
              report["pairs_used"].get<int>(), report["pairs"].get<int>(),
              report["left"]["rms_px"].get<double>(), report["right"]["rms_px"].get<double>(),
              report["rms_px"].get<double>(), report["row_rms_px"].get<double>());
  EXPECT_GE(report["pairs_used"].get<int>(), 13);
  EXPECT_LT(report["left"]["rms_px"], 0.5);
  EXPECT_LT(report["right"]["rms_px"], 0.5);
  EXPECT_LT(report["rms_px"], 0.5);
  EXPECT_LT(report["row_rms_px"], 0.5);
  // OpenCV's own calibration of the left eye stands beside the pictures: 535.9 px, with an outlier
  // of 1.2 px in it, which moves the focal length by some tenths of a per cent.
  EXPECT_NEAR(report["left"]["fx_px"].get<double>(), 535.9, 0.01 * 535.9);
  EXPECT_NE(read_file(out).find("\ncalibration_time: \"20"), std::string::npos) << read_file(out);
  EXPECT_TRUE(fs::exists(folder / "stereo.coverage.png"));
  const auto coverage = vision::read_picture(folder / "stereo.coverage.png");
  ASSERT_TRUE(coverage) << coverage.error().message;

  // Its results are replaced, its pictures are not.
  fs::create_directory(folder / "some");
  copy_pairs(folder / "some", {"01"});
  const auto before = fs::file_size(folder / "some/left01.jpg");
  EXPECT_EQ(calibrate(folder / "some", out, {"--coverage", folder / "some/left01.jpg"}).exit_code,
            2);
  EXPECT_EQ(fs::file_size(folder / "some/left01.jpg"), before);
  EXPECT_EQ(calibrate(kPictures, out).exit_code, 0);

  // The file serves: corners of both eyes come to lie on the same rows of rectified pictures, found
  // anew in them.
  const auto calibration = vision::read_calibration(out);
  ASSERT_TRUE(calibration) << calibration.error().message;
  const vision::Rectifier rectifier(*calibration);
  double sum = 0;
  int corners = 0;
  for (const std::string number : {"01", "03", "07", "12"}) {
    const auto left = vision::read_picture(kPictures + "/left" + number + ".jpg");
    const auto right = vision::read_picture(kPictures + "/right" + number + ".jpg");
    ASSERT_TRUE(left && right);
    vision::StereoImages rectified;
    rectifier.rectify({*left, *right}, rectified);
    const auto a = vision::find_board(rectified.left, {9, 6, 0.025});
    auto b = vision::find_board(rectified.right, {9, 6, 0.025});
    if (a.empty() || b.empty()) continue;  // the board reaches beyond the rectified picture
    if ((a.back() - a.front()).dot(b.back() - b.front()) < 0) std::reverse(b.begin(), b.end());
    for (std::size_t i = 0; i < a.size(); ++i, ++corners) {
      sum += (a[i].y() - b[i].y()) * (a[i].y() - b[i].y());
      EXPECT_GT(a[i].x(), b[i].x()) << "disparity, picture " << number;
    }
  }
  ASSERT_GE(corners, 2 * 54);
  std::printf("rows in rectified pictures: %.3f px rms\n", std::sqrt(sum / corners));
  EXPECT_LT(std::sqrt(sum / corners), 0.5);
}

// What was calibrated from photographs gives depth in them: the board is a plane of known size.
TEST(Calibrate, TheBoardIsAPlaneInTheDepthOfItsPhotographs) {
  const TemporaryFolder folder;
  ASSERT_EQ(calibrate(kPictures, folder / "stereo.yml", {"--json"}).exit_code, 0);
  copy_pairs(folder.path(), {"01"});
  const Finished seen = run(
      kaz({"vision", "run", "--left", folder / "left01.jpg", "--right", folder / "right01.jpg",
           "--calibration", folder / "stereo.yml", "--modules", "color,depth,planes", "--nearest",
           "0.3", "--export", "depth,points", "--out", folder / "found", "--json"}));
  ASSERT_EQ(seen.exit_code, 0) << seen.err;
  const json pair = parse_json(seen.out)["frames"][0];
  EXPECT_FALSE(pair["ball"]["found"].get<bool>());  // grey pictures
  EXPECT_GT(pair["depth"]["known"].get<double>(), 0.1);
  ASSERT_FALSE(pair["planes"].empty());

  // The plane through the corners, by where both eyes see them in rectified pictures.
  const auto calibration = vision::read_calibration(folder / "stereo.yml");
  ASSERT_TRUE(calibration);
  vision::StereoImages rectified;
  vision::Rectifier(*calibration)
      .rectify({*vision::read_picture(folder / "left01.jpg"),
                *vision::read_picture(folder / "right01.jpg")},
               rectified);
  const auto a = vision::find_board(rectified.left, {9, 6, 0.025});
  auto b = vision::find_board(rectified.right, {9, 6, 0.025});
  ASSERT_EQ(a.size(), 54u);
  ASSERT_EQ(b.size(), 54u);
  if ((a.back() - a.front()).dot(b.back() - b.front()) < 0) std::reverse(b.begin(), b.end());
  const vision::CameraModel& c = calibration->rectified;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double z = c.fx * c.baseline_m / (a[i].x() - b[i].x());
    points.emplace_back((a[i].x() - c.cx) * z / c.fx, (a[i].y() - c.cy) * z / c.fy, z);
  }
  // A ruler: 8 squares along a row. 1 % is 0.5 px of 50 over the board, far more than corners err.
  EXPECT_NEAR((points[8] - points[0]).norm(), 8 * 0.025, 0.01 * 8 * 0.025);
  // That of the segments which holds the board's middle.
  const Eigen::Vector3d middle = points[22];
  const json* board = nullptr;
  for (const json& plane : pair["planes"]) {
    const auto& box = plane["box_px"];
    if (box[0] < a[22].x() && a[22].x() < box[2] && box[1] < a[22].y() && a[22].y() < box[3] &&
        (board == nullptr || plane["pixels"] > (*board)["pixels"]))
      board = &plane;
  }
  ASSERT_NE(board, nullptr) << pair["planes"].dump();
  const Eigen::Vector3d normal((*board)["normal"][0], (*board)["normal"][1], (*board)["normal"][2]);
  const double off = normal.dot(middle) + (*board)["distance_m"].get<double>();
  const double one_px_m = middle.z() * middle.z() / (c.fx * c.baseline_m);
  std::printf("board at %.3f m: plane %.4f m off, %.2f px of disparity\n", middle.z(), off,
              off / one_px_m);
  EXPECT_LT(std::abs(off), 0.6 * one_px_m);
  EXPECT_TRUE(fs::exists(folder / "found/left01.jpg.vision.png"));
  EXPECT_TRUE(fs::exists(folder / "found/left01.jpg.depth.png"));
  EXPECT_GT(fs::file_size(folder / "found/left01.jpg.points.ply"),
            15 * pair["depth"]["known"].get<double>() * 640 * 480);

  // The cameras the wrong way round.
  copy_pairs(folder.path(), {"02"});
  const Finished wrong = run(kaz({"vision", "run", "--left", folder / "right02.jpg", "--right",
                                  folder / "left02.jpg", "--calibration", folder / "stereo.yml",
                                  "--modules", "depth", "--out", folder / "wrong"}));
  EXPECT_NE(wrong.out.find("left and right seem exchanged"), std::string::npos) << wrong.out;

  // Three of them, of which the first and the last hardly differ either way: a pattern that repeats.
  copy_pairs(folder.path(), {"03"});
  const Finished three = run(kaz({"vision", "run", "--left", folder / "right0[1-3].jpg", "--right",
                                  folder / "left0[1-3].jpg", "--calibration", folder / "stereo.yml",
                                  "--modules", "depth", "--out", folder / "wrong", "--json"}));
  EXPECT_EQ(three.exit_code, 0) << three.err;
  EXPECT_NE(three.out.find("left and right seem exchanged"), std::string::npos) << three.out;
  const Finished as_named =
      run(kaz({"vision", "run", "--left", folder / "left0[1-3].jpg", "--right",
               folder / "right0[1-3].jpg", "--calibration", folder / "stereo.yml", "--modules",
               "depth", "--out", folder / "right", "--json"}));
  EXPECT_EQ(as_named.out.find("exchanged"), std::string::npos) << as_named.out;

  // One file for both eyes is refused before anything is written, a copy of it once it is read.
  fs::copy_file(folder / "left01.jpg", folder / "copy01.jpg");
  const auto with_right = [&](const std::string& right) {
    return run(
        kaz({"vision", "run", "--left", folder / "left01.jpg", "--right", right, "--calibration",
             folder / "stereo.yml", "--modules", "depth", "--out", folder / "same"}));
  };
  const Finished one_file = with_right(folder / "left01.jpg");
  EXPECT_EQ(one_file.exit_code, 2) << one_file.out;
  EXPECT_NE(one_file.err.find("are the same picture"), std::string::npos) << one_file.err;
  EXPECT_FALSE(fs::exists(folder / "same"));
  const Finished copied = with_right(folder / "copy01.jpg");
  EXPECT_EQ(copied.exit_code, 1) << copied.out;
  EXPECT_NE(copied.err.find("are the same picture"), std::string::npos) << copied.err;
  EXPECT_EQ(copied.out.find("exchanged"), std::string::npos) << copied.out;
}

TEST(Calibrate, NamesAndLeavesOutWhatShowsNoBoard) {
  const TemporaryFolder folder;
  copy_pairs(folder.path(), {"01", "03", "04", "05", "06", "07", "08"});
  const std::string whole = read_file(folder / "left05.jpg");
  write_file(folder / "left05.jpg", whole.substr(0, whole.size() / 2));
  fs::copy_file(kPictures + "/aloeL.jpg", folder / "unused.jpg");
  const vision::Image grey{640, 480, std::vector<std::uint8_t>(640 * 480 * 3, 128)};
  write_file(folder / "right07.jpg",
             "P6\n640 480\n255\n" + std::string(grey.rgb.begin(), grey.rgb.end()));
  const Finished finished = calibrate(folder.path(), folder / "stereo.json");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_NE(finished.out.find("left out: left05.jpg: is not a valid JPEG"), std::string::npos)
      << finished.out;
  EXPECT_NE(finished.out.find("left out: right07.jpg: the whole board is not visible"),
            std::string::npos)
      << finished.out;
  EXPECT_NE(finished.out.find("5 of 7 pairs"), std::string::npos) << finished.out;
  EXPECT_NE(finished.err.find("100 %"), std::string::npos) << finished.err;  // progress
  EXPECT_TRUE(vision::read_calibration(folder / "stereo.json"));
}

TEST(Calibrate, WritesTwoFilesForRos) {
  const TemporaryFolder folder;
  copy_pairs(folder.path(), {"01", "03", "04", "06", "08"});
  const std::string out = folder / "l.yaml" + "," + folder / "r.yaml";
  ASSERT_EQ(calibrate(folder.path(), out).exit_code, 0);
  const auto both = vision::read_calibration(out);
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_NEAR(both->rectified.baseline_m, 0.083, 0.003);
  EXPECT_TRUE(fs::exists(folder / "l.coverage.png"));
  EXPECT_NE(read_file(folder / "r.yaml").find("camera_name: right"), std::string::npos);
}

TEST(Calibrate, RefusesWhatGivesNoCalibration) {
  const TemporaryFolder folder;
  const std::string out = folder / "stereo.yml";
  expect_refusal(calibrate(folder.path(), out), 2, out, {"left[0-9]*.jpg", "no picture"});
  copy_pairs(folder.path(), {"01"});
  expect_refusal(calibrate(folder.path(), out), 1, out, {"1 of 1 pairs", "5 are needed"});
  copy_pairs(folder.path(), {"03"});
  // A board of another size.
  expect_refusal(calibrate(folder.path(), out, {}, "8x7"), 1, out,
                 {"0 of 2 pairs", "left01.jpg", "8x7"});
  // One eye has a picture more.
  fs::remove(folder / "right03.jpg");
  expect_refusal(calibrate(folder.path(), out), 2, out,
                 {"left03.jpg", "no partner", "2 left, 1 right"});
  // One is of another size.
  fs::copy_file(kPictures + "/aloeR.jpg", folder / "right03.jpg");
  expect_refusal(calibrate(folder.path(), out), 2, out, {"right03.jpg", "640 x 480", "equal size"});
}

TEST(Calibrate, RefusesPairsThatDoNotBelongTogether) {
  const TemporaryFolder folder;
  const std::string out = folder / "stereo.yml";
  const std::vector<std::string> numbers{"01", "03", "04", "05", "06", "07", "08"};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    fs::copy_file(kPictures + "/left" + numbers[i] + ".jpg",
                  folder / ("left" + numbers[i] + ".jpg"));
    fs::copy_file(kPictures + "/right" + numbers[(i + 1) % numbers.size()] + ".jpg",
                  folder / ("right" + numbers[i] + ".jpg"));
  }
  const Finished finished = calibrate(folder.path(), out);
  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  EXPECT_FALSE(fs::exists(out));
  // Left and right exchanged.
  const Finished exchanged =
      run(kaz({"calibrate", "stereo", "--left", kPictures + "/right0*.jpg", "--right",
               kPictures + "/left0*.jpg", "--board", "9x6", "--square", "0.025", "--out", out}));
  expect_refusal(exchanged, 1, out, {"exchanged"});
}

TEST(Calibrate, RefusesTheSamePicturesForBothEyes) {
  const TemporaryFolder folder;
  const std::string out = folder / "stereo.yml";
  const auto with_right = [&](const std::string& right) {
    return run(kaz({"calibrate", "stereo", "--left", kPictures + "/left0[1-7].jpg", "--right",
                    right, "--board", "9x6", "--square", "0.025", "--out", out}));
  };
  expect_refusal(with_right(kPictures + "/left0[1-7].jpg"), 2, out,
                 {"left01.jpg", "the same picture", "two eyes"});
  // Another file, and a pixel of its own: nearly the same, and of one eye all the same.
  for (const std::string number : {"01", "02", "03", "04", "05", "06", "07"}) {
    auto picture = vision::read_picture(kPictures + "/left" + number + ".jpg");
    ASSERT_TRUE(picture) << picture.error().message;
    picture->rgb[0] ^= 1;
    write_file(folder / ("copy" + number + ".ppm"),
               "P6\n640 480\n255\n" + std::string(picture->rgb.begin(), picture->rgb.end()));
  }
  expect_refusal(with_right(folder / "copy*.ppm"), 1, out, {});
}

TEST(Calibrate, RefusesCopiesOfAPair) {
  const TemporaryFolder folder;
  const std::string out = folder / "stereo.yml";
  copy_pairs(folder.path(), {"01", "03", "04", "05", "06"});
  for (const std::string side : {"left", "right"})
    fs::copy_file(kPictures + "/" + side + "04.jpg", folder / (side + "14.jpg"));
  expect_refusal(calibrate(folder.path(), out), 2, out,
                 {"left04.jpg", "left14.jpg", "exactly the same place"});
}

TEST(Calibrate, RefusesImplausibleSizes) {
  const TemporaryFolder folder;
  const std::string out = folder / "stereo.yml";
  const auto with_square = [&](const std::string& square_m) {
    return run(kaz({"calibrate", "stereo", "--left", kPictures + "/left0[1-8].jpg", "--right",
                    kPictures + "/right0[1-8].jpg", "--board", "9x6", "--square", square_m, "--out",
                    out}));
  };
  for (const std::string square_m : {"25", "0.51", "0.0009"})
    expect_refusal(with_square(square_m), 2, out,
                   {"--square " + square_m, "must be 0.001 to 0.5 m", "0.025"});
  expect_refusal(with_square("0.5"), 1, out, {"distance of the eyes, 1.6", "(--square)"});
  expect_refusal(with_square("0.001"), 1, out, {"distance of the eyes, 0.003", "(--square)"});
  expect_refusal(calibrate(kPictures, out, {"--max-rms", "100"}), 2, out, {"--max-rms"});
}

TEST(Calibrate, WrongWordsGetOneSentence) {
  const TemporaryFolder folder;
  expect_refusal(calibrate(kPictures, folder / "a.yml", {}, "9by6"), 2, folder / "a.yml",
                 {"9by6", "9x6"});
  expect_refusal(calibrate(kPictures, folder / "a.txt"), 2, folder / "a.txt", {".yml"});
  expect_refusal(calibrate(kPictures, folder / "no/a.yml"), 2, folder / "no/a.yml", {"no folder"});
  const Finished help = run(kaz({"calibrate", "stereo", "--help"}));
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("Examples:"), std::string::npos);
}

}  // namespace
}  // namespace kaz::test
