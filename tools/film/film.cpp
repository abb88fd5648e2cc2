// Draws the pictures of a film from a recording.
// SPDX-License-Identifier: Apache-2.0
#include "tools/film/film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>

#include "shared/base/one_line.hpp"
#include "sim/body/world/world.h"
#include "sim/render/camera.h"
#include "sim/runtime/eyes/eyes.h"
#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/formats/png_picture.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/paths.h"
#include "tools/base/provenance.h"
#include "tools/drawing/figure.h"
#include "tools/film/film_encoder.h"
#include "tools/lockstep/recorded_run.h"
#include "tools/replay/recorded_backend.h"
#include "tools/replay/recorded_poses.h"
#include "tools/run/outside_view.h"

namespace kaz::tools {
namespace {

constexpr int kWidth = 640, kHeight = 480;
// Of the eye's picture with its frame, and of the time below, px.
constexpr int kEyeWidth = 204, kEyeHeight = 154, kMargin = 12, kText = 20;
constexpr int kSeenWidth = kEyeWidth - 2 * figure::kFrame_px,
              kSeenHeight = kEyeHeight - 2 * figure::kFrame_px;
constexpr std::size_t kMaxPictures = 100'000;

// Poses between two that are recorded.
sim::ScenePose between(const RecordedPoses& a, const RecordedPoses& b, Time at,
                       std::size_t frames) {
  const double share = seconds(at - a.time) / seconds(b.time - a.time);
  sim::ScenePose pose;
  for (std::size_t i = 0; i < frames; ++i) {
    const Eigen::Isometry3d &from = a.frames[i], &to = b.frames[i];
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(from.linear()).slerp(share, Eigen::Quaterniond(to.linear()));
    const Eigen::Vector3d place =
        from.translation() + share * (to.translation() - from.translation());
    pose.frames.push_back(Eigen::Translation3d(place) * turn);
  }
  return pose;
}

// The camera follows slowly: mean of what is to be seen from so long before to so long after.
class SlowCamera {
 public:
  SlowCamera(const sim::Scene& scene, const std::vector<RecordedPoses>& poses) {
    for (const RecordedPoses& one : poses) {
      times_.push_back(one.time);
      framings_.push_back(framing_of(scene, {one.frames}));
    }
  }
  Framing at(Time now) const {
    constexpr double kReach_s = 2;
    const Time reach = from_seconds(kReach_s);
    Framing mean;
    double weights = 0;
    const auto first = std::ranges::lower_bound(times_, now - reach) - times_.begin();
    for (auto i = static_cast<std::size_t>(first); i < times_.size() && times_[i] <= now + reach;
         ++i) {
      const double away = seconds(times_[i] - now) / kReach_s;
      const double weight = 1e-6 + 1 + std::cos(std::numbers::pi * away);
      mean.middle += weight * framings_[i].middle;
      mean.extent_m += weight * framings_[i].extent_m;
      weights += weight;
    }
    return {mean.middle / weights, mean.extent_m / weights};
  }

 private:
  std::vector<Time> times_;
  std::vector<Framing> framings_;
};

// Where a picture in the picture hides least of robot and ball.
class Corner {
 public:
  Corner(const sim::Scene& scene, const std::vector<RecordedPoses>& poses,
         const SlowCamera& camera) {
    std::array<std::size_t, kCorners.size()> hidden{};
    for (std::size_t i = 0; i < poses.size(); i += kEvery) {
      const sim::View view = outside_view(scene, camera.at(poses[i].time), kWidth);
      const Eigen::Isometry3d optical_from_world = view.world_from_optical.inverse();
      for (std::size_t k = 1; k < scene.frames.size(); ++k) {
        const Eigen::Vector3d p = optical_from_world * poses[i].frames[k].translation();
        if (p.z() <= 0 || !is_subject(scene.frames[k])) continue;
        const Eigen::Vector2d px = view.camera.pixel(p);
        for (std::size_t corner = 0; corner < kCorners.size(); ++corner) {
          const auto [left, top] = kCorners[corner];
          if (px.x() >= left - kAround && px.x() < left + kEyeWidth + kAround &&
              px.y() >= top - kAround && px.y() < top + kEyeHeight + kAround)
            ++hidden[corner];
        }
      }
    }
    place_ = kCorners[static_cast<std::size_t>(std::ranges::min_element(hidden) - hidden.begin())];
  }
  std::pair<int, int> place() const { return place_; }  // left, top

 private:
  static constexpr int kRight = kWidth - kEyeWidth - kMargin,
                       kBottom = kHeight - kEyeHeight - kMargin;
  static constexpr std::size_t kEvery = 10;
  static constexpr int kAround = 40;  // px: links have a size
  // Not the lower left one, where the time is. Of equal ones the first is taken.
  static constexpr std::array<std::pair<int, int>, 3> kCorners{
      {{kRight, kMargin}, {kMargin, kMargin}, {kRight, kBottom}}};
  std::pair<int, int> place_;
};

// Picture of the left eye: as recorded, or else drawn.
class EyePicture {
 public:
  EyePicture() = default;
  // `name` is the recording's name in error messages. `view_rad` is the horizontal field of view with which
  // the eye is drawn; nullopt: it is not drawn.
  EyePicture(std::string name, std::vector<lockstep::RecordedRun::Pair> pairs,
             std::optional<double> view_rad)
      : name_(std::move(name)), pairs_(std::move(pairs)), view_rad_(view_rad) {}

  // Content of the corner picture.
  const char* kind() const { return !pairs_.empty() ? "recorded" : view_rad_ ? "drawn" : "none"; }
  // Call it in order of time: a recorded picture is the newest until then.
  Result<const figure::Image*> at(Time now, const sim::ScenePose& pose,
                                  const Eigen::Isometry3d& world_from_eye, sim::Light light,
                                  sim::Renderer& renderer);

 private:
  std::string name_;
  std::vector<lockstep::RecordedRun::Pair> pairs_;
  std::optional<double> view_rad_;
  std::size_t next_pair_ = 0;  // the first that is later than the picture in the corner
  figure::Image image_;
};

Result<const figure::Image*> EyePicture::at(Time now, const sim::ScenePose& pose,
                                            const Eigen::Isometry3d& world_from_eye,
                                            sim::Light light, sim::Renderer& renderer) {
  // Before the first picture came the eyes were shut, and what is there is drawn.
  if (!pairs_.empty() && (pairs_.front().exposure <= now || !view_rad_)) {
    std::size_t next = next_pair_;
    while (next < pairs_.size() && pairs_[next].exposure <= now) ++next;
    if (next == 0 || next == next_pair_) return &image_;
    next_pair_ = next;
    const auto decoded = sim::decode_png(pairs_[next - 1].left_png);
    if (!decoded)
      return fail(Fault::usage,
                  name_ + ": cannot decode a picture of the left eye: " + decoded.error().message);
    image_ = figure::framed(figure::resize(*decoded, kSeenWidth, kSeenHeight));
  } else if (view_rad_) {
    sim::View view;
    view.camera = sim::camera_of_view(kSeenWidth, kSeenHeight, *view_rad_);
    view.world_from_optical = world_from_eye;
    view.samples_per_axis = 2;
    view.light = light;
    figure::Image picture;
    KAZ_TRY(renderer.render(pose, view, picture));
    image_ = figure::framed(picture);
  }
  return &image_;
}

class Film {
 public:
  static Result<Film> of(const FilmOptions& options);
  std::size_t pictures() const { return pictures_; }
  double length_s() const { return static_cast<double>(pictures_) / fps_; }
  const char* eye() const { return eye_.kind(); }
  // In order: the recorded eye's picture is the newest until then.
  Result<figure::Image> draw(std::size_t number);

 private:
  std::string phase_at(Time now) const;
  // Returns the field of view of the eye that can be drawn, rad; nullopt without eyes.
  Result<std::optional<double>> open_world(BackendOptions backend);

  std::vector<RecordedPoses> poses_;  // with the left eye as last frame, if it can be drawn
  sim::Scene scene_;
  std::unique_ptr<sim::Renderer> renderer_;
  std::optional<SlowCamera> camera_;
  std::optional<Corner> corner_;
  std::vector<std::pair<std::uint64_t, std::string>> phases_;  // in order of time
  std::size_t pictures_ = 0;
  int fps_ = 0;
  double pace_ = 1;
  EyePicture eye_;
};

Result<std::optional<double>> Film::open_world(BackendOptions backend) {
  const std::string robot =
      backend.robot_file.empty() ? KAZ_TRY(data_file("robot/kaz/kaz.urdf")) : backend.robot_file;
  const auto world = KAZ_TRY(
      sim::World::load(KAZ_TRY(world_file(backend.world)), robot, {.hung = backend.suspended}));
  scene_ = world->scene();
  renderer_ = KAZ_TRY(sim::make_raster_renderer());
  KAZ_TRY(renderer_->set_scene(scene_));
  if (world->head_frame() < 0 || backend.eyes == sim::EyeKind::none) return std::optional<double>();
  const auto file = KAZ_TRY(
      sim::CameraFile::load(std::filesystem::path(robot).replace_filename("camera.json").string()));
  return std::optional<double>(file.eye.rectified_view_rad);
}

Result<Film> Film::of(const FilmOptions& options) {
  Film film;
  const auto recording = KAZ_TRY(sim::McapRecording::load_run(options.recording));
  auto run = KAZ_TRY(lockstep::RecordedRun::of(recording, options.recording));
  auto recorded = KAZ_TRY(recorded_backend(recording, options.recording));
  find_beside(recorded.backend, options.recording);
  const auto eye_view_rad = KAZ_TRY(film.open_world(recorded.backend));
  film.eye_ = EyePicture(options.recording, std::move(run.pairs), eye_view_rad);
  std::vector<std::string> frames(film.scene_.frames.begin() + 1, film.scene_.frames.end());
  if (eye_view_rad) frames.emplace_back("left_eye");
  film.poses_ = KAZ_TRY(recorded_poses(recording, frames, options.recording));
  for (RecordedPoses& poses : film.poses_)  // the world itself is frame 0
    poses.frames.insert(poses.frames.begin(), Eigen::Isometry3d::Identity());
  film.camera_.emplace(film.scene_, film.poses_);
  film.corner_.emplace(film.scene_, film.poses_, *film.camera_);
  film.phases_ = recorded_phases(recording);
  std::ranges::stable_sort(film.phases_, {}, &std::pair<std::uint64_t, std::string>::first);
  film.fps_ = options.fps;
  film.pace_ = options.pace;
  const double length_s =
      seconds(film.poses_.back().time - film.poses_.front().time) / options.pace;
  const double pictures = std::floor(length_s * options.fps + 1e-6) + 1;
  if (pictures > static_cast<double>(kMaxPictures))
    return fail(Fault::usage, options.recording + ": the film would have more than " +
                                  std::to_string(kMaxPictures) +
                                  " pictures; give a larger --pace or a smaller --video-fps");
  film.pictures_ = static_cast<std::size_t>(pictures);
  return film;
}

std::string Film::phase_at(Time now) const {
  const auto after = std::ranges::upper_bound(phases_, static_cast<std::uint64_t>(now.count()), {},
                                              &std::pair<std::uint64_t, std::string>::first);
  return after == phases_.begin() ? "" : cut_text(one_line(std::prev(after)->second), 40);
}

Result<figure::Image> Film::draw(std::size_t number) {
  const Time now = poses_.front().time + from_seconds(pace_ * static_cast<double>(number) / fps_);
  const auto after = std::ranges::upper_bound(poses_, now, {}, &RecordedPoses::time);
  const RecordedPoses& before = *std::prev(after);
  sim::ScenePose pose = after == poses_.end() ? sim::ScenePose{before.frames}
                                              : between(before, *after, now, before.frames.size());
  const Eigen::Isometry3d last = pose.frames.back();
  pose.frames.resize(scene_.frames.size());
  figure::Image picture;
  KAZ_TRY(renderer_->render(pose, outside_view(scene_, camera_->at(now), kWidth), picture));
  const figure::Image* eye = KAZ_TRY(eye_.at(now, pose, last, scene_.light, *renderer_));
  const auto [left, top] = corner_->place();
  figure::paste(picture, *eye, left, top);
  char text[80];
  std::snprintf(text, sizeof text, "%.1f s  %s", seconds(now), phase_at(now).c_str());
  figure::draw_text(picture, kMargin, picture.height - kMargin, text, kText, figure::kWhite);
  return picture;
}

// The pictures into the file. What is wrong with ffmpeg may be a full disk.
Result<void> encode(Film& film, const FilmFormat& format, int fps, OutputFile& file,
                    const host::Interrupt& interrupt, Progress& progress) {
  auto encoder =
      KAZ_TRY(FilmEncoder::begin(format, {kWidth, kHeight, fps}, file.part(), interrupt));
  for (std::size_t i = 0; i < film.pictures(); ++i) {
    const figure::Image picture = KAZ_TRY(film.draw(i));
    KAZ_TRY(encoder.add(picture.rgb));
    progress.update(static_cast<double>(i + 1) / static_cast<double>(film.pictures()),
                    "picture " + std::to_string(i + 1) + " of " + std::to_string(film.pictures()));
  }
  return encoder.finish();
}

}  // namespace

Result<void> make_film(const FilmOptions& options) {
  const auto format = KAZ_TRY(film_format(options.path));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  auto file = KAZ_TRY(OutputFile::open(options.path, "--video"));
  FilmOptions complete = options;
  if (complete.fps == 0) complete.fps = format.fps;
  Film film = KAZ_TRY(Film::of(complete));
  const auto size = [&file]() -> std::uint64_t {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(file.part(), none);
    return none ? 0 : bytes;
  };
  {
    Progress progress("kaz replay", options.json);
    auto encoded = encode(film, format, complete.fps, file, interrupt, progress);
    progress.done();
    if (!encoded && encoded.error().fault == Fault::environment) KAZ_TRY(file.check_room(64 << 10));
    KAZ_TRY(encoded);
  }
  const std::uint64_t bytes = size();
  KAZ_TRY(file.commit());
  if (!options.json) {
    std::printf("%s: %zu pictures, %.1f s, %.1f MB\n", options.path.c_str(), film.pictures(),
                film.length_s(), 1e-6 * static_cast<double>(bytes));
    return {};
  }
  print_json({{"recording", options.recording},
              {"path", options.path},
              {"frames", film.pictures()},
              {"fps", complete.fps},
              {"seconds", film.length_s()},
              {"width", kWidth},
              {"height", kHeight},
              {"bytes", bytes},
              {"eye", film.eye()},
              {"provenance", provenance_json()}});
  return {};
}

}  // namespace kaz::tools
