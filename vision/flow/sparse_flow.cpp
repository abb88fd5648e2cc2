// Corners, and OpenCV's pyramidal Lucas-Kanade there and back.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/sparse_flow.h"

#include <string>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "vision/flow/flow_pair.h"
#include "vision/image/opencv_quiet.h"

namespace kaz::vision {
namespace {

Result<void> check_options(const SparseFlowOptions& o) {
  if (o.window_px < 5 || o.window_px > 51 || o.window_px % 2 == 0)
    return fail(Fault::usage, "sparse flow: window_px must be odd and 5 to 51");
  if (o.max_points < 1 || o.levels < 0 || o.levels > 8)
    return fail(Fault::usage, "sparse flow: max_points must be above 0, and levels must be 0 to 8");
  if (!(o.min_quality > 0 && o.min_quality < 1) || !(o.min_separation_px >= 0) ||
      !(o.max_return_px > 0))
    return fail(
        Fault::usage,
        "sparse flow: min_quality must be above 0 and below 1, min_separation_px at least 0, "
        "and max_return_px above 0");
  return {};
}

}  // namespace

struct SparseFlow::State {
  SparseFlowOptions options;
  cv::Mat grey_before, grey_after;
  std::vector<cv::Mat> pyramid_before, pyramid_after;
  std::vector<cv::Point2f> from, to, back;
  std::vector<std::uint8_t> there, returned;
  std::vector<float> error;

  Result<void> find(const ImageView& before, const FrameInfo& info_before, const ImageView& after,
                    const FrameInfo& info_after, const std::vector<Eigen::Vector2f>* points,
                    FlowPoints& flow) {
    flow.before = info_before;
    flow.after = info_after;
    flow.points.clear();
    if (auto ok = check_options(options); !ok) return ok;
    if (auto ok = check_flow_pair(before, info_before, after, info_after); !ok) return ok;
    try {
      const OpenCvQuiet quiet;
      const cv::Mat a = flow_grey(before, grey_before), b = flow_grey(after, grey_after);
      from.clear();
      if (points) {
        for (const auto& p : *points) from.emplace_back(p.x(), p.y());
      } else {
        cv::goodFeaturesToTrack(a, from, options.max_points, options.min_quality,
                                options.min_separation_px);
      }
      if (!from.empty()) follow(a, b, flow);
    } catch (const cv::Exception& e) {
      return fail(Fault::failed, std::string("sparse flow: OpenCV failed: ") + e.what());
    }
    return {};
  }

  void follow(const cv::Mat& a, const cv::Mat& b, FlowPoints& flow) {
    const cv::Size window(options.window_px, options.window_px);
    const int top = std::min(cv::buildOpticalFlowPyramid(a, pyramid_before, window, options.levels),
                             cv::buildOpticalFlowPyramid(b, pyramid_after, window, options.levels));
    cv::calcOpticalFlowPyrLK(pyramid_before, pyramid_after, from, to, there, error, window, top);
    cv::calcOpticalFlowPyrLK(pyramid_after, pyramid_before, to, back, returned, error, window, top);
    const auto inside = [&](const cv::Point2f& p) {
      return p.x >= 0 && p.y >= 0 && p.x <= static_cast<float>(a.cols - 1) &&
             p.y <= static_cast<float>(a.rows - 1);
    };
    for (std::size_t i = 0; i < from.size(); ++i) {
      FlowPoint p{{from[i].x, from[i].y}, {to[i].x, to[i].y}};
      if (there[i] && returned[i] && inside(from[i]) && inside(to[i])) {
        const cv::Point2f off = back[i] - from[i];
        p.return_px = std::hypot(off.x, off.y);
        p.status = p.return_px <= static_cast<float>(options.max_return_px)
                       ? FlowPoint::Status::followed
                       : FlowPoint::Status::inconsistent;
      }
      flow.points.push_back(p);
    }
  }
};

SparseFlow::SparseFlow(const SparseFlowOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
}
SparseFlow::~SparseFlow() = default;
SparseFlow::SparseFlow(SparseFlow&&) noexcept = default;
SparseFlow& SparseFlow::operator=(SparseFlow&&) noexcept = default;

Result<void> SparseFlow::find(const Image& before, const FrameInfo& info_before, const Image& after,
                              const FrameInfo& info_after, FlowPoints& flow) {
  return state_->find(image_view(before), info_before, image_view(after), info_after, nullptr,
                      flow);
}
Result<void> SparseFlow::find(const GreyPicture& before, const FrameInfo& info_before,
                              const GreyPicture& after, const FrameInfo& info_after,
                              FlowPoints& flow) {
  return state_->find(image_view(before), info_before, image_view(after), info_after, nullptr,
                      flow);
}
Result<void> SparseFlow::follow(const GreyPicture& before, const FrameInfo& info_before,
                                const GreyPicture& after, const FrameInfo& info_after,
                                const std::vector<Eigen::Vector2f>& points, FlowPoints& flow) {
  return state_->find(image_view(before), info_before, image_view(after), info_after, &points,
                      flow);
}

}  // namespace kaz::vision
