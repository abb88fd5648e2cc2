// Modules of the pipeline: each adapts one detector.
// SPDX-License-Identifier: Apache-2.0
#include "vision/pipeline/modules.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace kaz::vision {

namespace {

class ColorModule final : public Module {
 public:
  ColorModule(const BallOptions& options, Time latency) : detector_(options), latency_(latency) {}
  std::string name() const override { return "color"; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override {
    BallObservation ball = detector_.detect(frame.images().left, frame.info());
    if (ball.error) return tl::unexpected(*ball.error);
    return std::any(std::move(ball));
  }

 private:
  BallFinder detector_;
  Time latency_;
};

class DepthModule final : public Module {
 public:
  DepthModule(const DepthOptions& options, Time latency) : finder_(options), latency_(latency) {}
  std::string name() const override { return "depth"; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override {
    DepthImage depth;
    KAZ_TRY(finder_.find(frame.images(), frame.info(), depth));
    return std::any(std::move(depth));
  }

 private:
  DepthFinder finder_;
  Time latency_;
};

class FlowModule final : public Module {
 public:
  FlowModule(const FlowOptions& options, Time latency, Time longest)
      : finder_(options), latency_(latency), longest_(longest) {}
  std::string name() const override { return "flow"; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override {
    const auto before = std::exchange(before_, frame.shared_images());
    const FrameInfo info = std::exchange(info_, frame.info());
    FlowImage flow;
    flow.before = info;
    flow.after = frame.info();
    // What was left out in between is no gap of the camera's, where it is short: a module that is
    // late looks at every second frame.
    const Time passed = between(flow.after.exposure, info.exposure);
    const bool continued = std::exchange(looked_, false);
    if (before == nullptr || passed <= Time(0) || passed > longest_) {
      flow.before = flow.after;
      return std::any(std::move(flow));
    }
    KAZ_TRY(finder_.find(before->left, info, frame.images().left, frame.info(), flow, continued));
    looked_ = true;
    return std::any(std::move(flow));
  }

 private:
  FlowFinder finder_;
  Time latency_, longest_;
  bool looked_ = false;  // the finder has seen the picture of before_
  std::shared_ptr<const StereoImages> before_;
  FrameInfo info_;
};

class PlanesModule final : public Module {
 public:
  PlanesModule(const PlaneOptions& options, Time latency) : finder_(options), latency_(latency) {}
  std::string name() const override { return "planes"; }
  std::vector<std::string> needs() const override { return {"depth"}; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override {
    PlaneSegments planes;
    KAZ_TRY(finder_.find(frame.of<DepthImage>("depth"), planes));
    return std::any(std::move(planes));
  }

 private:
  PlaneSegmentFinder finder_;
  Time latency_;
};

class FloorModule final : public Module {
 public:
  FloorModule(const FloorEdgeOptions& options, Time latency) : edges_(options), latency_(latency) {}
  std::string name() const override { return "floor"; }
  std::vector<std::string> needs() const override { return {"planes", "depth"}; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override {
    PlaneSegments planes = frame.of<PlaneSegments>("planes");
    KAZ_TRY(edges_.sharpen(frame.images().left, planes, &frame.of<DepthImage>("depth")));
    return std::any(std::move(planes));
  }

 private:
  FloorEdges edges_;
  Time latency_;
};

class IndependentMotionModule final : public Module {
 public:
  IndependentMotionModule(const IndependentMotionOptions& options, Time latency)
      : finder_(options), latency_(latency) {}
  std::string name() const override { return "moving"; }
  std::vector<std::string> needs() const override { return {"flow", "depth"}; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override {
    const auto& flow = frame.of<FlowImage>("flow");
    const auto images = frame.shared_images();
    const auto before = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& one) {
      return one.sequence == flow.before.sequence;
    });
    MovingRegions moving;
    moving.before = moving.after = frame.info();
    Result<void> found;
    // No result if this module skipped the frame at which the flow begins.
    if (flow.width > 0 && before != kept_.end())
      found = finder_.find(flow, before->images->left, images->left, &frame.of<DepthImage>("depth"),
                           moving);
    kept_.push_back({frame.info().sequence, images});
    if (kept_.size() > kMaxKept) kept_.erase(kept_.begin());
    if (!found) return tl::unexpected(found.error());
    return std::any(std::move(moving));
  }

 private:
  static constexpr std::size_t kMaxKept = 6;
  struct Kept {
    std::uint64_t sequence;
    std::shared_ptr<const StereoImages> images;
  };
  IndependentMotionDetector finder_;
  Time latency_;
  std::vector<Kept> kept_;
};

}  // namespace

std::unique_ptr<Module> make_color_module(const BallOptions& options, Time latency) {
  return std::make_unique<ColorModule>(options, latency);
}
std::unique_ptr<Module> make_depth_module(const DepthOptions& options, Time latency) {
  return std::make_unique<DepthModule>(options, latency);
}
std::unique_ptr<Module> make_flow_module(const FlowOptions& options, Time latency, Time longest) {
  return std::make_unique<FlowModule>(options, latency, longest);
}
std::unique_ptr<Module> make_planes_module(const PlaneOptions& options, Time latency) {
  return std::make_unique<PlanesModule>(options, latency);
}
std::unique_ptr<Module> make_floor_module(const FloorEdgeOptions& options, Time latency) {
  return std::make_unique<FloorModule>(options, latency);
}

std::unique_ptr<Module> make_independent_motion_module(const IndependentMotionOptions& options,
                                                       Time latency) {
  return std::make_unique<IndependentMotionModule>(options, latency);
}

}  // namespace kaz::vision
