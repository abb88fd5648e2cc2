// Each module is a finder, told what to look at.
// SPDX-License-Identifier: Apache-2.0
#include "vision/modules.h"

#include <utility>

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
  BallDetector detector_;
  Time latency_;
};

class DepthModule final : public Module {
 public:
  DepthModule(const DepthOptions& options, Time latency) : finder_(options), latency_(latency) {}
  std::string name() const override { return "depth"; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override {
    DepthImage depth;
    if (auto found = finder_.find(frame.images(), frame.info(), depth); !found)
      return tl::unexpected(found.error());
    return std::any(std::move(depth));
  }

 private:
  DepthFinder finder_;
  Time latency_;
};

class PlanesModule final : public Module {
 public:
  PlanesModule(const PlaneOptions& options, Time latency) : finder_(options), latency_(latency) {}
  std::string name() const override { return "planes"; }
  std::vector<std::string> needs() const override { return {"depth"}; }
  Time latency() const override { return latency_; }
  Result<std::any> look(const Frame& frame) override {
    PlaneSegments planes;
    if (auto found = finder_.find(frame.of<DepthImage>("depth"), planes); !found)
      return tl::unexpected(found.error());
    return std::any(std::move(planes));
  }

 private:
  PlaneSegmentFinder finder_;
  Time latency_;
};

}  // namespace

std::unique_ptr<Module> make_color_module(const BallOptions& options, Time latency) {
  return std::make_unique<ColorModule>(options, latency);
}
std::unique_ptr<Module> make_depth_module(const DepthOptions& options, Time latency) {
  return std::make_unique<DepthModule>(options, latency);
}
std::unique_ptr<Module> make_planes_module(const PlaneOptions& options, Time latency) {
  return std::make_unique<PlanesModule>(options, latency);
}

}  // namespace kaz::vision
