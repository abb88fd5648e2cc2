// Hostile frames through a pipeline, and what comes out judged.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tools/fuzz/vision/hostile_frames.h"
#include "tools/fuzz/vision/targets.h"
#include "vision/color/ball_track.h"
#include "vision/depth/depth_file.h"
#include "vision/depth/swapped_cameras.h"
#include "vision/flow/independent_motion.h"
#include "vision/pipeline/modules.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::fuzz {
namespace {

using namespace kaz::vision;

Complaint judge(const FrameInfo& info, const BallObservation& ball) {
  if (!ball.found) return std::nullopt;
  if (ball.info.sequence != info.sequence) return "a ball has the sequence number of another frame";
  if (!std::isfinite(ball.center_u) || !std::isfinite(ball.center_v) ||
      !(ball.radius_px > 0 && ball.radius_px < 1e9) || !ball.direction.allFinite() ||
      !(ball.distance_m > 0 && std::isfinite(ball.distance_m)) ||
      !(ball.confidence >= 0 && ball.confidence <= 1))
    return "an invalid ball";
  return std::nullopt;
}

Complaint judge(const FrameInfo& info, const DepthImage& depth) {
  if (depth.width != info.camera.width || depth.height != info.camera.height ||
      depth.disparity_px.size() !=
          static_cast<std::size_t>(depth.width) * static_cast<std::size_t>(depth.height))
    return "a depth image of the wrong size";
  for (const float d : depth.disparity_px) {
    if (!(d >= 0 && d <= static_cast<float>(depth.width))) return "an invalid disparity";
  }
  return std::nullopt;
}

Complaint judge(const FrameInfo& info, const PlaneSegments& planes) {
  if (planes.width != info.camera.width || planes.height != info.camera.height ||
      planes.label.size() !=
          static_cast<std::size_t>(planes.width) * static_cast<std::size_t>(planes.height))
    return "planes of the wrong size";
  for (const std::uint8_t l : planes.label) {
    if (l > planes.segments.size()) return "a pixel with an invalid plane segment";
  }
  for (const PlaneSegment& s : planes.segments) {
    if (!s.normal.allFinite() || std::abs(s.normal.norm() - 1) > 1e-6 || !(s.distance_m > 0) ||
        !s.middle.allFinite() || s.left < 0 || s.top < 0 || s.right >= planes.width ||
        s.bottom >= planes.height)
      return "an invalid plane segment";
    if (s.floor && !info.posture_known) return "a floor without a known posture";
  }
  return std::nullopt;
}

Complaint judge(const FrameInfo& info, const FlowImage& flow) {
  if (flow.width == 0) return std::nullopt;
  if (flow.width != info.camera.width || flow.height != info.camera.height ||
      flow.flow_px.size() !=
          static_cast<std::size_t>(flow.width) * static_cast<std::size_t>(flow.height))
    return "flow of the wrong size";
  for (const Eigen::Vector2f& f : flow.flow_px) {
    if (std::isnan(f.x()) != std::isnan(f.y()) || std::isinf(f.x()) || std::isinf(f.y()))
      return "an invalid flow";
  }
  return std::nullopt;
}

Complaint judge(const FrameInfo& info, const MovingRegions& moving) {
  for (const MovingRegion& r : moving.regions) {
    if (r.left < 0 || r.top < 0 || r.right >= info.camera.width || r.bottom >= info.camera.height ||
        !r.velocity_px_s.allFinite() || (r.position_m && !r.position_m->allFinite()) ||
        (r.velocity_m_s && !r.velocity_m_s->allFinite()))
      return "an invalid moving region";
  }
  return std::nullopt;
}

// What moves, from the flow and the depth of the frame.
class Watch final : public Module {
 public:
  std::string name() const override { return "watch"; }
  std::vector<std::string> needs() const override { return {"flow", "depth"}; }
  Time latency() const override { return Time(0); }
  Result<std::any> look(const Frame& frame) override {
    const auto before = std::exchange(before_, frame.shared_images());
    MovingRegions moving;
    const auto& flow = frame.of<FlowImage>("flow");
    if (before == nullptr || flow.width == 0) return std::any(moving);
    KAZ_TRY(finder_.find(flow, before->left, frame.images().left, &frame.of<DepthImage>("depth"),
                         moving));
    return std::any(std::move(moving));
  }

 private:
  IndependentMotionDetector finder_;
  std::shared_ptr<const StereoImages> before_;
};

class Run {
 public:
  Run() : pipeline_({Pace::lockstep, Time(0)}) {
    add<BallObservation>(make_color_module({}));
    add<DepthImage>(make_depth_module({}));
    add<FlowImage>(make_flow_module({}));
    add<PlaneSegments>(make_planes_module({}));
    add<PlaneSegments>(make_floor_module({}));
    add<MovingRegions>(std::make_unique<Watch>());
    (void)pipeline_.subscribe<DepthImage>(
        "depth", [this](const Frame& f, const DepthImage* depth, const Error*) {
          if (depth != nullptr) write(f, *depth);
        });
    (void)pipeline_.subscribe<BallObservation>(
        "color", [this](const Frame& f, const BallObservation* ball, const Error*) {
          if (ball != nullptr) follow(f.info(), *ball);
        });
  }

  void submit(const HostileFrame& frame) {
    std::promise<std::shared_ptr<const StereoImages>> pixels;
    pixels.set_value(frame.images);
    pipeline_.submit({frame.info, pixels.get_future().share()});
    ++frames_;
    pipeline_.poll(Time::max());
  }
  Complaint end() {
    pipeline_.poll(Time::max());
    if (!complaint_ && answers_ != modules_ * frames_)
      complaint_ = std::to_string(answers_) + " answers of " + std::to_string(modules_) +
                   " modules to " + std::to_string(frames_) + " frames";
    return complaint_;
  }
  // Of the last frame.
  const std::optional<BallObservation>& ball() const { return ball_; }
  const std::vector<float>& disparities() const { return disparities_; }
  const std::vector<std::uint8_t>& labels() const { return labels_; }

 private:
  template <class T>
  void add(std::unique_ptr<Module> module) {
    const std::string name = module->name();
    ++modules_;
    (void)pipeline_.add(std::move(module));
    (void)pipeline_.subscribe<T>(
        name, [this, name](const Frame& frame, const T* value, const Error* error) {
          ++answers_;
          if (error != nullptr && error->message.empty()) complain(name + ": an empty error");
          if (value == nullptr) return forget(static_cast<const T*>(nullptr));
          if (const Complaint c = judge(frame.info(), *value)) complain(name + ": " + *c);
          keep(*value);
        });
  }
  void complain(const std::string& what) {
    if (!complaint_) complaint_ = what;
  }
  void forget(const BallObservation*) { ball_.reset(); }
  void forget(const DepthImage*) { disparities_.clear(); }
  void forget(const PlaneSegments*) { labels_.clear(); }
  template <class T>
  void forget(const T*) {}
  void keep(const BallObservation& b) { ball_ = b; }
  void keep(const DepthImage& d) { disparities_ = d.disparity_px; }
  void keep(const PlaneSegments& p) { labels_ = p.label; }
  template <class T>
  void keep(const T&) {}

  void write(const Frame& frame, const DepthImage& depth) {
    (void)eye_order(frame.images(), frame.info());
    PointCloud cloud;
    point_cloud(depth, cloud);
    if (!depth_png(depth) || !points_ply(cloud, frame.images().left))
      complain("the depth or the point cloud cannot be written");
  }

  void follow(const FrameInfo& info, const BallObservation& ball) {
    track_.observe(ball, info.foot_from_eye);
    if (!track_.known()) return;
    for (const Time t :
         {track_.latest(), info.exposure, later(track_.latest(), Time(100'000'000))}) {
      const BallState s = track_.at(t);
      if (!s.position.allFinite() || !s.velocity.allFinite() || !track_.aim(t).allFinite())
        return complain("the ball's track is not finite");
    }
  }

  Pipeline pipeline_;
  BallTrack track_;
  std::size_t modules_ = 0, frames_ = 0, answers_ = 0;
  Complaint complaint_;
  std::optional<BallObservation> ball_;
  std::vector<float> disparities_;
  std::vector<std::uint8_t> labels_;
};

}  // namespace

Complaint try_vision(Bytes bytes) {
  hil::fuzz::Choices choices(bytes);
  HostileFrames frames(choices);
  constexpr std::uint64_t kLast = 1'000'000;
  Run run;
  for (int i = 0; i < 8 && !choices.ended(); ++i) run.submit(frames.next());
  run.submit(valid_frame(kLast, Time(5'000'000'000)));
  if (const Complaint c = run.end()) return c;

  static const auto fresh = [] {
    auto alone = std::make_unique<Run>();
    alone->submit(valid_frame(kLast, Time(5'000'000'000)));
    (void)alone->end();
    return alone;
  }();
  if (!run.ball() || run.ball()->found != fresh->ball()->found ||
      run.ball()->distance_m != fresh->ball()->distance_m)
    return "hostile frames changed the ball that is found in a valid frame";
  if (run.disparities() != fresh->disparities())
    return "hostile frames changed the depth of a valid frame";
  if (run.labels() != fresh->labels()) return "hostile frames changed the planes of a valid frame";
  return std::nullopt;
}

}  // namespace kaz::fuzz
