// Vision on arrays: ball, depth, flow, planes, as the robot has them.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "python/src/python.h"
#include "vision/color/ball.h"
#include "vision/depth/depth.h"
#include "vision/flow/flow.h"
#include "vision/planes/plane_segments.h"

namespace kaz::python {
namespace {

using Picture = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;
using Disparity = py::array_t<float, py::array::c_style | py::array::forcecast>;

vision::FrameInfo info_of(const vision::CameraModel& camera, double time = 0) {
  vision::FrameInfo info;
  info.camera = camera;
  info.exposure = from_seconds(time);
  return info;
}

// Each keeps memory between its calls.
using BallDetector = Locked<vision::BallFinder>;
using DepthFinder = Locked<vision::DepthFinder>;
using FlowFinder = Locked<vision::FlowFinder>;
using PlaneFinder = Locked<vision::PlaneSegmentFinder>;

py::object find_ball(BallDetector& detector, const Picture& picture,
                     const vision::CameraModel& camera) {
  const vision::Image image = image_of(picture);
  const auto found =
      detector.alone([&](vision::BallFinder& d) { return d.detect(image, info_of(camera)); });
  if (found.error) raise(*found.error);
  if (!found.found) return py::none();
  py::dict ball;
  ball["u"] = found.center_u;
  ball["v"] = found.center_v;
  ball["radius_px"] = found.radius_px;
  ball["distance_m"] = found.distance_m;
  ball["position"] = vector_of(found.position());
  ball["confidence"] = found.confidence;
  return ball;
}

py::array_t<bool> color_mask(BallDetector& detector) {
  const vision::Mask mask = detector.alone([](vision::BallFinder& d) { return d.mask(); });
  py::array_t<bool> selected({mask.height, mask.width});
  std::ranges::transform(mask.pixels, selected.mutable_data(),
                         [](std::uint8_t pixel) { return pixel != 0; });
  return selected;
}

py::array_t<float> find_depth(DepthFinder& finder, const Picture& left, const Picture& right,
                              const vision::CameraModel& camera) {
  const vision::StereoImages images{image_of(left), image_of(right)};
  vision::DepthImage depth;
  value_of(
      finder.alone([&](vision::DepthFinder& f) { return f.find(images, info_of(camera), depth); }));
  return py::array_t<float>({depth.height, depth.width}, depth.disparity_px.data());
}

py::array_t<float> find_flow(FlowFinder& finder, const Picture& before, const Picture& after,
                             const vision::CameraModel& camera) {
  const vision::Image first = image_of(before), second = image_of(after);
  vision::FlowImage flow;
  // Of the times the displacements do not depend.
  value_of(finder.alone([&](vision::FlowFinder& f) {
    return f.find(first, info_of(camera, 0), second, info_of(camera, 1), flow);
  }));
  return py::array_t<float>({flow.height, flow.width, 2},
                            reinterpret_cast<const float*>(flow.flow_px.data()));
}

py::tuple find_planes(PlaneFinder& finder, const Disparity& disparity,
                      const vision::CameraModel& camera) {
  if (disparity.ndim() != 2)
    raise({Fault::usage, "a disparity image must be an array of height x width numbers in px"});
  vision::DepthImage depth;
  depth.info = info_of(camera);
  depth.height = static_cast<int>(disparity.shape(0));
  depth.width = static_cast<int>(disparity.shape(1));
  depth.disparity_px.assign(disparity.data(), disparity.data() + disparity.size());
  vision::PlaneSegments found;
  value_of(finder.alone([&](vision::PlaneSegmentFinder& f) { return f.find(depth, found); }));
  py::list segments;
  for (const vision::PlaneSegment& segment : found.segments) {
    py::dict one;
    one["plane"] = segment.plane;
    one["normal"] = vector_of(segment.normal);
    one["distance_m"] = segment.distance_m;
    one["middle"] = vector_of(segment.middle);
    one["length_m"] = segment.length_m;
    one["width_m"] = segment.width_m;
    one["error_m"] = segment.error_m;
    one["pixels"] = segment.pixels;
    segments.append(one);
  }
  return py::make_tuple(segments,
                        py::array_t<std::uint8_t>({found.height, found.width}, found.label.data()));
}

}  // namespace

void add_vision(py::module_& module) {
  static_assert(sizeof(Eigen::Vector2f) == 2 * sizeof(float));
  py::class_<BallDetector>(module, "BallDetector")
      .def(py::init([](double radius_m, double min_confidence) {
             if (!(radius_m > 0) || !std::isfinite(radius_m))
               raise({Fault::usage, "radius_m: must be above 0 m"});
             vision::BallOptions options;
             options.radius_m = radius_m;
             options.min_confidence = min_confidence;
             return std::make_unique<BallDetector>("this BallDetector",
                                                   std::make_unique<vision::BallFinder>(options));
           }),
           py::arg("radius_m") = vision::BallOptions{}.radius_m,
           py::arg("min_confidence") = vision::BallOptions{}.min_confidence)
      .def("find", &find_ball, py::arg("picture"), py::arg("camera"))
      .def("mask", &color_mask);
  py::class_<DepthFinder>(module, "DepthFinder")
      .def(py::init([](double nearest_m, int block_px) {
             vision::DepthOptions options;
             options.nearest_m = nearest_m;
             options.block_px = block_px;
             return std::make_unique<DepthFinder>("this DepthFinder",
                                                  std::make_unique<vision::DepthFinder>(options));
           }),
           py::arg("nearest_m") = vision::DepthOptions{}.nearest_m,
           py::arg("block_px") = vision::DepthOptions{}.block_px)
      .def("find", &find_depth, py::arg("left"), py::arg("right"), py::arg("camera"));
  py::class_<FlowFinder>(module, "FlowFinder")
      .def(py::init([] {
        return std::make_unique<FlowFinder>("this FlowFinder",
                                            std::make_unique<vision::FlowFinder>());
      }))
      .def("find", &find_flow, py::arg("before"), py::arg("after"), py::arg("camera"));
  py::class_<PlaneFinder>(module, "PlaneFinder")
      .def(py::init([](std::uint64_t seed) {
             vision::PlaneOptions options;
             options.seed = seed;
             return std::make_unique<PlaneFinder>(
                 "this PlaneFinder", std::make_unique<vision::PlaneSegmentFinder>(options));
           }),
           py::arg("seed") = 1)
      .def("find", &find_planes, py::arg("disparity").none(false), py::arg("camera"));
}

}  // namespace kaz::python
