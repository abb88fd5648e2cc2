// The camera model against OpenCV: projection, calibration file, calibration.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "sim/render/renderer_kind.h"
#include "sim/render/scenes_testing.h"
#include "sim/render/sensor/edge_corners_testing.h"
#include "sim/render/sensor/sensor.h"
#include "vision/calibration/rectify.h"

namespace kaz::sim {
namespace {

constexpr int kColumns = 8, kRows = 6;  // inner corners
constexpr double kSquare_m = 0.025;

// A board of squares without bevels: meshes, white backing 0.1 mm behind the black squares.
class Board {
 public:
  Board() {
    std::string name = (std::filesystem::temp_directory_path() / "kaz-board-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) folder_ = name;
    std::ostringstream vertices, faces;
    int count = 0;
    const auto quad = [&](double x0, double y0, double x1, double y1, double z) {
      for (const auto& [x, y] : {std::pair{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}})
        vertices << "v " << x << ' ' << y << ' ' << z << '\n';
      faces << 'f';
      for (int i = 0; i < 4; ++i) faces << ' ' << ++count;
      faces << '\n';
    };
    const auto write = [&](const std::string& file) {
      std::ofstream(folder_ + "/" + file) << vertices.str() << faces.str();
      vertices.str("");
      faces.str("");
      count = 0;
    };
    const double m = kSquare_m;
    for (int row = -1; row < kRows; ++row) {
      for (int column = -1; column < kColumns; ++column) {
        if ((row + column) % 2 != 0) continue;
        quad(column * m, row * m, (column + 1) * m, (row + 1) * m, 0);
      }
    }
    write("black.obj");
    quad(-2 * m, -2 * m, (kColumns + 1) * m, (kRows + 1) * m, -0.0001);
    write("white.obj");
    add("black.obj", {0.1F, 0.1F, 0.1F});
    add("white.obj", {0.95F, 0.95F, 0.95F});
  }
  ~Board() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }

  const Scene& scene() const { return scene_.scene; }
  // With its middle at `at`, turned out of the camera's axes; rows go down, columns to the right.
  ScenePose pose(const Eigen::Isometry3d& world_from_optical, const Eigen::Vector3d& at,
                 const Eigen::Vector3d& turn) {
    optical_from_board_ =
        Eigen::Translation3d(at) * Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()) *
        Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()) *
        Eigen::Translation3d(-0.5 * (kColumns - 1) * kSquare_m, -0.5 * (kRows - 1) * kSquare_m, 0);
    for (std::size_t i = 1; i < scene_.pose.frames.size(); ++i)
      scene_.pose.frames[i] = world_from_optical * optical_from_board_;
    return scene_.pose;
  }
  const Eigen::Isometry3d& optical_from_board() const { return optical_from_board_; }
  // From the upper left, as OpenCV finds them. y of the board goes up.
  static std::vector<cv::Point3f> corners() {
    std::vector<cv::Point3f> corners;
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        corners.emplace_back(static_cast<float>(column * kSquare_m),
                             static_cast<float>((kRows - 1 - row) * kSquare_m), 0.0F);
      }
    }
    return corners;
  }

 private:
  void add(const std::string& file, const Rgb& color) {
    const int frame = scene_.add(Shape::Kind::mesh, {1, 1, 1}, {0, 0, 0}, color);
    Visual& visual = scene_.scene.visuals[static_cast<std::size_t>(frame) - 1];
    visual.shape.mesh_path = folder_ + "/" + file;
  }
  std::string folder_;
  TestScene scene_;
  Eigen::Isometry3d optical_from_board_ = Eigen::Isometry3d::Identity();
};

cv::Mat camera_matrix(const vision::Lens& l) {
  return (cv::Mat_<double>(3, 3) << l.fx, 0, l.cx, 0, l.fy, l.cy, 0, 0, 1);
}
cv::Mat distortion(const vision::Lens& l) {
  const auto& d = l.distortion;
  return (cv::Mat_<double>(1, 5) << d[0], d[1], d[2], d[3], d[4]);
}

EyeModel eye_of_width(int width) {
  EyeModel model;
  model.width = width;
  model.height = width * 3 / 4;
  return model;
}

struct Shot {
  std::vector<cv::Point2f> found, by_window, projected;
  double largest = 0, rms = 0, window_rms = 0, shift = 0;
};

// A board seen through lens and sensor: where OpenCV finds its corners, and where it projects them.
class Camera {
 public:
  Camera(int width, Board& board, Renderer& renderer)
      : board_(board),
        renderer_(renderer),
        model_(eye_of_width(width)),
        calibration_(make_calibration(model_, 1, 0.04)),
        sensor_(model_, calibration_, Sensor::Eye::left, 1) {}

  // Empty if not all corners are found.
  std::optional<Shot> shoot(const Eigen::Vector3d& at, const Eigen::Vector3d& turn) {
    View view;
    view.world_from_optical = look_at({0, 0, 0.5}, {-0.55, 0.50, -0.5});  // with the key light
    view.camera = sensor_.ideal();
    // The model is compared, not the raster: with one sample a pixel, an edge along the rows may lie
    // anywhere within a pixel and look the same.
    view.samples_per_axis = 4;
    vision::Image ideal, picture;
    const ScenePose pose = board_.pose(view.world_from_optical, at, turn);
    const auto drawn = renderer_.render(pose, view, ideal);
    EXPECT_TRUE(drawn) << drawn.error().message;
    if (!drawn) return std::nullopt;
    sensor_.expose(ideal, ++exposure_, picture);
    const cv::Mat rgb(picture.height, picture.width, CV_8UC3, picture.rgb.data());
    cv::Mat grey;
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    Shot shot;
    if (!cv::findChessboardCorners(grey, {kColumns, kRows}, shot.found)) return std::nullopt;
    const int reach = model_.width / 64;  // half the window: less than half a square
    cv::cornerSubPix(grey, shot.found, {reach, reach}, {-1, -1},
                     {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-4});
    shot.by_window = shot.found;
    shot.found = EdgeCorners(grey, shot.found, kColumns).corners();
    cv::Mat rotation(3, 3, CV_64F), vector;
    const Eigen::Matrix3d r = board_.optical_from_board().linear();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rotation.at<double>(i, j) = r(i, j);
    cv::Rodrigues(rotation, vector);
    const Eigen::Vector3d t = board_.optical_from_board().translation();
    cv::projectPoints(Board::corners(), vector, cv::Vec3d(t.x(), t.y(), t.z()),
                      camera_matrix(lens()), distortion(lens()), shot.projected);
    // The board looks the same from its other end.
    if (cv::norm(shot.found.front() - shot.projected.front()) >
        cv::norm(shot.found.front() - shot.projected.back()))
      std::reverse(shot.projected.begin(), shot.projected.end());
    for (std::size_t i = 0; i < shot.found.size(); ++i) {
      const double error = cv::norm(shot.by_window[i] - shot.projected[i]);
      shot.window_rms += error * error / static_cast<double>(shot.found.size());
    }
    shot.window_rms = std::sqrt(shot.window_rms);
    for (std::size_t i = 0; i < shot.found.size(); ++i) {
      const double error = cv::norm(shot.found[i] - shot.projected[i]);
      shot.largest = std::max(shot.largest, error);
      shot.rms += error * error / static_cast<double>(shot.found.size());
    }
    shot.rms = std::sqrt(shot.rms);
    cv::Point2f sum(0, 0);
    for (std::size_t i = 0; i < shot.found.size(); ++i) sum += shot.found[i] - shot.projected[i];
    shot.shift = cv::norm(sum) / static_cast<double>(shot.found.size());
    return shot;
  }
  const vision::Lens& lens() const { return calibration_.left.lens; }

 private:
  Board& board_;
  Renderer& renderer_;
  EyeModel model_;
  vision::StereoCalibration calibration_;
  Sensor sensor_;
  std::uint64_t exposure_ = 0;
};

struct Placement {
  Eigen::Vector3d at, turn;
};
// All over the picture, up to its corners, and tilted. None has edges along the pixels' rows: four
// samples a pixel leave such an edge, all of it, an eighth of a pixel open.
const std::vector<Placement>& placements() {
  static const std::vector<Placement> all{
      {{0, 0, 0.25}, {0, 0, 0.1}},          {{-0.12, -0.08, 0.27}, {0.3, -0.4, 0.1}},
      {{0.12, -0.08, 0.27}, {0.3, 0.4, 0}}, {{-0.12, 0.08, 0.27}, {-0.3, -0.4, -0.1}},
      {{0.12, 0.08, 0.27}, {-0.3, 0.4, 0}}, {{0.02, 0.01, 0.22}, {0.5, 0, 0.2}},
      {{-0.02, 0, 0.24}, {0, 0.6, -0.2}},
  };
  return all;
}

// Of all placements on which OpenCV finds the board, taken once for all tests.
const std::vector<Shot>& shots(int width) {
  static const auto taken = [] {
    std::map<int, std::vector<Shot>> all;
    Board board;
    const auto renderer = std::move(*maker_of(kDefaultRenderer)());
    EXPECT_TRUE(renderer->set_scene(board.scene()));
    for (const int each : {320, 640}) {
      Camera camera(each, board, *renderer);
      for (const auto& [at, turn] : placements()) {
        if (auto shot = camera.shoot(at, turn)) all[each].push_back(std::move(*shot));
      }
    }
    return all;
  }();
  return taken.at(width);
}

TEST(OpenCv, ProjectsTheBoardWhereTheEyeSeesIt) {
  for (const int width : {320, 640}) {
    double squares = 0, largest = 0, by_windows = 0;
    for (const Shot& shot : shots(width)) {
      const cv::Point2f at = shot.projected[kColumns / 2];
      squares += shot.rms * shot.rms;
      by_windows += shot.window_rms * shot.window_rms;
      largest = std::max(largest, shot.largest);
      EXPECT_LT(shot.largest, 0.2) << width << ", board about " << at;
      // Of 48 corners' mean the noise is a seventh: nothing is shifted.
      EXPECT_LT(shot.shift, 0.05) << width << ", board about " << at;
    }
    const auto seen = static_cast<double>(shots(width).size());
    EXPECT_GE(seen, 5) << width;
    std::printf(
        "%d px: %.0f boards, corners %.3f px rms, largest %.3f px; by windows %.3f px rms\n", width,
        seen, std::sqrt(squares / seen), largest, std::sqrt(by_windows / seen));
  }
}

TEST(OpenCv, CalibratesTheEyeToItsOwnNumbers) {
  const EyeModel model = eye_of_width(640);
  std::vector<std::vector<cv::Point2f>> pictures;
  for (const Shot& shot : shots(640)) pictures.push_back(shot.found);
  ASSERT_GE(pictures.size(), 5u);
  const std::vector<std::vector<cv::Point3f>> boards(pictures.size(), Board::corners());
  cv::Mat matrix, coefficients;
  std::vector<cv::Mat> rotations, translations;
  const double rms = cv::calibrateCamera(boards, pictures, {model.width, model.height}, matrix,
                                         coefficients, rotations, translations, cv::CALIB_FIX_K3);
  EXPECT_LT(rms, 0.2);
  // Seven boards fix these to about 0.3 % (OpenCV's own estimate of the deviations).
  const vision::Lens lens = make_calibration(model, 1, 0.04).left.lens;
  EXPECT_NEAR(matrix.at<double>(0, 0), lens.fx, 0.01 * lens.fx);
  EXPECT_NEAR(matrix.at<double>(1, 1), lens.fy, 0.01 * lens.fy);
  EXPECT_NEAR(matrix.at<double>(0, 2), lens.cx, 2);
  EXPECT_NEAR(matrix.at<double>(1, 2), lens.cy, 2);
  EXPECT_NEAR(coefficients.at<double>(0), lens.distortion[0], 0.02);
}

TEST(OpenCv, ReadsTheCalibrationFileAndRectifiesAlike) {
  const EyeModel model = eye_of_width(320);
  const auto calibration = make_calibration(model, 3, 0.04);
  cv::FileStorage file(calibration.yaml(), cv::FileStorage::READ | cv::FileStorage::MEMORY);
  ASSERT_TRUE(file.isOpened());
  EXPECT_EQ(static_cast<int>(file["image_width"]), 320);
  EXPECT_EQ(static_cast<int>(file["image_height"]), 240);
  const auto matrix = [&](const char* name) {
    cv::Mat m;
    file[name] >> m;
    EXPECT_FALSE(m.empty()) << name;
    return m;
  };
  const cv::Mat k1 = matrix("camera_matrix_left"), d1 = matrix("distortion_coefficients_left"),
                k2 = matrix("camera_matrix_right"), d2 = matrix("distortion_coefficients_right"),
                r1 = matrix("R1"), r2 = matrix("R2"), p1 = matrix("P1"), p2 = matrix("P2"),
                r = matrix("R"), t = matrix("T"), q = matrix("Q");
  EXPECT_EQ(d1.cols, 5);
  EXPECT_EQ(k1.at<double>(0, 2), calibration.left.lens.cx);

  // A point in both eyes, projected by R and T and rectified by R1, P1 and R2, P2, lies in one row;
  // Q gives it back.
  const cv::Mat point = (cv::Mat_<double>(3, 1) << 0.05, -0.08, 0.5);  // in the left camera
  const auto rectified = [](const cv::Mat& in_camera, const cv::Mat& k, const cv::Mat& d,
                            const cv::Mat& turn, const cv::Mat& p) {
    const std::vector<cv::Point3d> points{cv::Point3d(in_camera)};
    std::vector<cv::Point2d> pixels, straight;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), k, d, pixels);
    cv::undistortPoints(pixels, straight, k, d, turn, p.colRange(0, 3),
                        {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-10});
    return straight.front();
  };
  const cv::Point2d left = rectified(point, k1, d1, r1, p1),
                    right = rectified(cv::Mat(r * point + t), k2, d2, r2, p2);
  EXPECT_NEAR(left.y, right.y, 1e-3);
  const cv::Mat back = q * (cv::Mat_<double>(4, 1) << left.x, left.y, left.x - right.x, 1.0);
  const cv::Mat expected = r1 * point;
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(back.at<double>(i) / back.at<double>(3), expected.at<double>(i), 1e-4);

  // OpenCV's maps and ours bend a picture alike.
  vision::StereoImages raw, ours;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const auto code =
          static_cast<std::uint8_t>(128 + 100 * std::sin(0.11 * u) * std::cos(0.13 * v));
      raw.left.rgb.insert(raw.left.rgb.end(), 3, code);
    }
  }
  raw.left.width = 320;
  raw.left.height = 240;
  raw.right = raw.left;
  vision::Rectifier(calibration).rectify(raw, ours);
  cv::Mat map_x, map_y, theirs;
  cv::initUndistortRectifyMap(k1, d1, r1, p1, {320, 240}, CV_32FC1, map_x, map_y);
  cv::remap(cv::Mat(240, 320, CV_8UC3, raw.left.rgb.data()), theirs, map_x, map_y,
            cv::INTER_LINEAR);
  int compared = 0;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const float x = map_x.at<float>(v, u), y = map_y.at<float>(v, u);
      if (x < 0 || y < 0 || x > 318 || y > 238) continue;  // OpenCV blends with black there
      ++compared;
      // Slopes up to 13 codes a pixel, places in 1/32 px there and 1/128 px here: 0.3, and rounding.
      ASSERT_NEAR(ours.left.rgb[static_cast<std::size_t>(v * 320 + u) * 3],
                  theirs.at<cv::Vec3b>(v, u)[0], 1.0)
          << u << " " << v;
    }
  }
  EXPECT_GT(compared, 70'000);
}

}  // namespace
}  // namespace kaz::sim
