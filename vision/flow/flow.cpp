// Dense flow: OpenCV's inverse search (DIS), and validation of its result.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "vision/flow/flow_pair.h"
#include "vision/image/opencv_quiet.h"

namespace kaz::vision {
namespace {

constexpr int kSmall = 4;  // factor by which the inverse search's finest pictures are smaller
constexpr int kPatch = 7;  // odd, of small pixels; the inverse search's are 8
constexpr float kNoise2 =
    0.5F;  // codes^2, variance of the difference of two small pictures; 2 codes a pixel
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Result<void> check_options(const FlowOptions& o) {
  if (!(o.max_error_px > 0) || !(o.max_unlike > 0) || !(o.max_step_px > 0))
    return fail(Fault::usage, "flow: max_error_px, max_unlike and max_step_px must be above 0");
  return {};
}

}  // namespace

struct FlowFinder::State {
  FlowOptions options;
  cv::Ptr<cv::DISOpticalFlow> search;
  cv::Size searched;  // the search fits its scales to the first pictures' size
  cv::Mat grey_before, grey_after, flow;
  cv::Mat small8[2], small[2];
  // See compare(); by small pixel, half a patch of zeros around, summed in place.
  using Products = std::array<float, 12>;
  std::vector<Products> sums;
  std::vector<std::uint8_t> compared;

  Result<void> find(const ImageView& before, const FrameInfo& info_before, const ImageView& after,
                    const FrameInfo& info_after, FlowImage& image) {
    image.before = info_before;
    image.after = info_after;
    if (auto ok = check_options(options); !ok) return ok;
    if (auto ok = check_flow_pair(before, info_before, after, info_after); !ok) return ok;
    image.width = before.width;
    image.height = before.height;
    image.flow_px.resize(static_cast<std::size_t>(before.width) *
                         static_cast<std::size_t>(before.height));
    try {
      const OpenCvQuiet quiet;
      compute(flow_grey(before, grey_before), flow_grey(after, grey_after), image);
    } catch (const cv::Exception& e) {
      return fail(Fault::failed, std::string("flow: OpenCV gave up: ") + e.what());
    }
    return {};
  }

  void compute(const cv::Mat& before, const cv::Mat& after, FlowImage& image) {
    if (!search || searched != before.size()) {
      search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST);
      searched = before.size();
    }
    flow.release();  // otherwise it would be the initial estimate
    search->calc(before, after, flow);
    const cv::Size size(before.cols / kSmall, before.rows / kSmall);
    const cv::Mat* const full[] = {&before, &after};
    for (int i = 0; i < 2; ++i) {
      cv::resize(*full[i], small8[i], size, 0, 0, cv::INTER_AREA);
      small8[i].convertTo(small[i], CV_32F);
    }
    compare();
    sum_patches(small[0].size());
    judge(image);
    mark(image);
  }

  cv::Point middle(int x, int y) const {  // of a small pixel, in the full picture
    return {std::min((2 * x + 1) * flow.cols / (2 * small[0].cols), flow.cols - 1),
            std::min((2 * y + 1) * flow.rows / (2 * small[0].rows), flow.rows - 1)};
  }

  // By small pixel, with gradient (gx, gy), brightness q, change d along the flow and weight w:
  // gx gx, gx gy, gy gy, gx d, gy d, d d, d, w, gx, gy, q, q q. The weight is 0 where the flow
  // leaves the picture.
  void compare() {
    const cv::Mat &a = small[0], &b = small[1];
    const auto across = static_cast<std::size_t>(a.cols + kPatch);
    sums.assign(across * static_cast<std::size_t>(a.rows + kPatch), {});
    compared.assign(static_cast<std::size_t>(a.size().area()), 0);
    const float per_x = static_cast<float>(a.cols) / static_cast<float>(flow.cols);
    const float per_y = static_cast<float>(a.rows) / static_cast<float>(flow.rows);
    for (int y = 1; y + 1 < a.rows; ++y) {
      const float *up = a.ptr<float>(y - 1), *row = a.ptr<float>(y), *down = a.ptr<float>(y + 1);
      for (int x = 1; x + 1 < a.cols; ++x) {
        const auto& f = flow.at<cv::Vec2f>(middle(x, y));
        const float to_x = static_cast<float>(x) + f[0] * per_x;
        const float to_y = static_cast<float>(y) + f[1] * per_y;
        if (!(to_x >= 0 && to_y >= 0 && to_x < static_cast<float>(a.cols - 1) &&
              to_y < static_cast<float>(a.rows - 1)))
          continue;
        const int i = static_cast<int>(to_x), j = static_cast<int>(to_y);
        const float s = to_x - static_cast<float>(i), t = to_y - static_cast<float>(j);
        const float *here = b.ptr<float>(j) + i, *below = b.ptr<float>(j + 1) + i;
        const float there =
            (1 - t) * ((1 - s) * here[0] + s * here[1]) + t * ((1 - s) * below[0] + s * below[1]);
        const float q = row[x] - 128, d = there - row[x];
        const float gx = (row[x + 1] - row[x - 1]) / 2, gy = (down[x] - up[x]) / 2;
        sums[static_cast<std::size_t>(y + kPatch / 2) * across +
             static_cast<std::size_t>(x + kPatch / 2)] = {
            gx * gx, gx * gy, gy * gy, gx * d, gy * d, d * d, d, 1, gx, gy, q, q * q};
        compared[static_cast<std::size_t>(y * a.cols + x)] = 1;
      }
    }
  }

  // Sums over the patch around each small pixel, separably; pixels beyond the edge have weight 0. No
  // running sums, whose rounding errors would accumulate.
  void sum_patches(cv::Size size) {
    const auto across = static_cast<std::size_t>(size.width + kPatch);
    for (const std::size_t step : {across, std::size_t{1}}) {
      for (std::size_t i = 0; i + (kPatch - 1) * step < sums.size(); ++i) {
        Products sum = sums[i];
        for (std::size_t r = 1; r < kPatch; ++r) {
          for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += sums[i + r * step][k];
        }
        sums[i] = sum;
      }
    }
  }

  // Validates each cell by the weighted means over its patch, all of the small pictures (units: small px):
  //   structure tensor G = (xx xy; xy yy), smaller eigenvalue
  //   `lesser` = (xx + yy) / 2 - sqrt(((xx - yy) / 2)^2 + xy^2);
  //   residual variance s^2 (`unlike`) = <d d> - <d>^2, brightness variance (`varies`) = <q q> - <q>^2;
  //   similarity: s^2 <= max_unlike varies + noise;
  //   standard error: s^2 / (n lesser) <= max_error^2, n = kPatch^2;
  //   further Lucas-Kanade step: G^-1 b with b = <g d> - <g> <d>, no longer than max_step.
  // Certainty: n G / s^2, in 1/px^2 of the full picture.
  void judge(FlowImage& image) {
    const cv::Size cells = small[0].size();
    image.cells_across = cells.width;
    image.cells_down = cells.height;
    image.certainty.assign(static_cast<std::size_t>(cells.area()), {});
    auto* to = image.certainty.data();
    constexpr float kMinShare = 0.5F;  // of the patch that was compared
    const float error2 =
        static_cast<float>(options.max_error_px * options.max_error_px) / (kSmall * kSmall);
    const float step2 =
        static_cast<float>(options.max_step_px * options.max_step_px) / (kSmall * kSmall);
    const std::uint8_t* was_compared = compared.data();
    for (int y = 0; y < cells.height; ++y) {
      const Products* sum =
          &sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(cells.width + kPatch)];
      for (int x = 0; x < cells.width; ++x, ++to, ++sum, ++was_compared) {
        const float *h = sum->data(), *m = h + 4, *n = h + 8;
        const float w = m[3];
        if (*was_compared == 0 || w < kMinShare * kPatch * kPatch) continue;
        const float xx = h[0] / w, xy = h[1] / w, yy = h[2] / w;
        const float lesser = (xx + yy) / 2 - std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy);
        if (!(lesser > 0)) continue;
        const float d = m[2] / w, q = n[2] / w;
        const float unlike = m[1] / w - d * d, varies = n[3] / w - q * q;
        if (unlike > static_cast<float>(options.max_unlike) * varies + kNoise2) continue;
        if (std::max(unlike, kNoise2) > error2 * (kPatch * kPatch) * lesser) continue;
        const float bx = h[3] / w - d * n[0] / w, by = m[0] / w - d * n[1] / w;
        const float det = xx * yy - xy * xy;
        const float sx = (yy * bx - xy * by) / det, sy = (xx * by - xy * bx) / det;
        if (!(sx * sx + sy * sy <= step2)) continue;
        const float per = kPatch * kPatch / (std::max(unlike, kNoise2) * kSmall * kSmall);
        *to = {per * xx, per * xy, per * yy};
      }
    }
  }

  // Copies the flow and sets it to NaN in the cells that are not valid.
  void mark(FlowImage& image) const {
    const auto width = static_cast<std::size_t>(image.width);
    for (int v = 0; v < image.height; ++v) {
      Eigen::Vector2f* to = &image.flow_px[static_cast<std::size_t>(v) * width];
      std::memcpy(static_cast<void*>(to), flow.ptr(v), width * sizeof *to);
      const FlowCertainty* row =
          &image.certainty[static_cast<std::size_t>(std::min(v / kSmall, image.cells_down - 1)) *
                           static_cast<std::size_t>(image.cells_across)];
      for (int x = 0; x < image.cells_across; ++x) {
        if (row[x].xx > 0) continue;
        const int end = x + 1 == image.cells_across ? image.width : (x + 1) * kSmall;
        std::fill(to + x * kSmall, to + end, Eigen::Vector2f(kNan, kNan));
      }
    }
  }
};

FlowFinder::FlowFinder(const FlowOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
}
FlowFinder::~FlowFinder() = default;
FlowFinder::FlowFinder(FlowFinder&&) noexcept = default;
FlowFinder& FlowFinder::operator=(FlowFinder&&) noexcept = default;

Result<void> FlowFinder::find(const Image& before, const FrameInfo& info_before, const Image& after,
                              const FrameInfo& info_after, FlowImage& flow) {
  return state_->find(image_view(before), info_before, image_view(after), info_after, flow);
}
Result<void> FlowFinder::find(const GreyPicture& before, const FrameInfo& info_before,
                              const GreyPicture& after, const FrameInfo& info_after,
                              FlowImage& flow) {
  return state_->find(image_view(before), info_before, image_view(after), info_after, flow);
}

}  // namespace kaz::vision
