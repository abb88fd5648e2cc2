// What vision makes of a run's pictures, for viewers.
// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/view_observer.h"

#include <string>

#include "tools/drawing/vision_views.h"
#include "vision/color/ball.h"
#include "vision/depth/depth.h"
#include "vision/flow/flow.h"
#include "vision/pipeline/pipeline.h"
#include "vision/planes/plane_segments.h"

namespace kaz::tools {
namespace {

constexpr double kLongestFlow_px = 8;  // in full colour

// A module's results as pictures, which `draw` makes of a copy, on a thread of the view's.
template <class T>
void show(vision::Pipeline& pipeline, viewer::View& view, const std::string& module,
          vision::Image (*draw)(const vision::StereoImages&, const T&)) {
  if (!pipeline.has(module)) return;
  const std::uint32_t channel = view.add_pictures("/vision/" + module);
  (void)pipeline.subscribe<T>(
      module, [&view, channel, draw](const vision::Frame& frame, const T* value, const Error*) {
        if (value == nullptr || !view.wants_picture(channel, frame.info())) return;
        view.picture(channel, frame.info(), [images = frame.shared_images(), copy = *value, draw] {
          return draw(*images, copy);
        });
      });
}

}  // namespace

void ViewObserver::begin_vision(vision::Pipeline& pipeline) {
  show<vision::DepthImage>(pipeline, view_, "depth",
                           [](const vision::StereoImages&, const vision::DepthImage& depth) {
                             return figure::depth_picture(depth);
                           });
  show<vision::FlowImage>(pipeline, view_, "flow",
                          [](const vision::StereoImages&, const vision::FlowImage& flow) {
                            return figure::flow_picture(flow, kLongestFlow_px);
                          });
  show<vision::PlaneSegments>(
      pipeline, view_, "floor",
      [](const vision::StereoImages& images, const vision::PlaneSegments& planes) {
        return figure::plane_picture(images.left, planes);
      });
  if (!pipeline.has("color")) return;
  (void)pipeline.subscribe<vision::BallObservation>(
      "color",
      [this](const vision::Frame& frame, const vision::BallObservation* ball, const Error*) {
        if (ball != nullptr) view_.ball(frame.info(), *ball);
      });
}

}  // namespace kaz::tools
