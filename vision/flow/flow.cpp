// Dense flow: OpenCV's inverse search (DIS), and validation of its result.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "vision/flow/flow_cells.h"
#include "vision/flow/flow_pair.h"
#include "vision/image/opencv_quiet.h"

namespace kaz::vision {
namespace {

constexpr int kSmall = kFlowSmall;
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
  FlowProducts products;
  std::vector<int> middle_column;             // of small pixels, in the full picture
  std::vector<float> there, compared;         // of a row: see FlowProducts::set_row()
  std::vector<float> row_xx, row_xy, row_yy;  // certainty of a row

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
    judge(image);
    mark(image);
  }

  // Middle of a small pixel in the full picture.
  static int middle(int small_pixel, int small_pixels, int pixels) {
    return std::min((2 * small_pixel + 1) * pixels / (2 * small_pixels), pixels - 1);
  }

  // Brightness of the later small picture along the flow, for each pixel of the earlier one.
  void compare() {
    const cv::Mat &a = small[0], &b = small[1];
    const auto columns = static_cast<std::size_t>(a.cols);
    products.resize(a.cols, a.rows);
    middle_column.resize(columns);
    for (int x = 0; x < a.cols; ++x)
      middle_column[static_cast<std::size_t>(x)] = middle(x, a.cols, flow.cols);
    there.assign(columns, 0);
    compared.assign(columns, 0);
    const float per_x = static_cast<float>(a.cols) / static_cast<float>(flow.cols);
    const float per_y = static_cast<float>(a.rows) / static_cast<float>(flow.rows);
    for (int y = 1; y + 1 < a.rows; ++y) {
      const auto* flows = flow.ptr<cv::Vec2f>(middle(y, a.rows, flow.rows));
      for (int x = 1; x + 1 < a.cols; ++x) {
        const auto k = static_cast<std::size_t>(x);
        const auto& f = flows[middle_column[k]];
        const float to_x = static_cast<float>(x) + f[0] * per_x;
        const float to_y = static_cast<float>(y) + f[1] * per_y;
        there[k] = compared[k] = 0;
        if (!(to_x >= 0 && to_y >= 0 && to_x < static_cast<float>(a.cols - 1) &&
              to_y < static_cast<float>(a.rows - 1)))
          continue;
        const int i = static_cast<int>(to_x), j = static_cast<int>(to_y);
        const float s = to_x - static_cast<float>(i), t = to_y - static_cast<float>(j);
        const float *here = b.ptr<float>(j) + i, *below = b.ptr<float>(j + 1) + i;
        there[k] =
            (1 - t) * ((1 - s) * here[0] + s * here[1]) + t * ((1 - s) * below[0] + s * below[1]);
        compared[k] = 1;
      }
      products.set_row(y, a.ptr<float>(y - 1), a.ptr<float>(y), a.ptr<float>(y + 1), there.data(),
                       compared.data());
    }
  }

  void judge(FlowImage& image) {
    const cv::Size cells = small[0].size();
    const auto across = static_cast<std::size_t>(cells.width);
    image.cells_across = cells.width;
    image.cells_down = cells.height;
    image.certainty.resize(static_cast<std::size_t>(cells.area()));
    for (std::vector<float>* row : {&row_xx, &row_xy, &row_yy}) row->resize(across);
    const FlowLimits limits{
        static_cast<float>(options.max_unlike),
        static_cast<float>(options.max_error_px * options.max_error_px) / (kSmall * kSmall),
        static_cast<float>(options.max_step_px * options.max_step_px) / (kSmall * kSmall)};
    FlowCertainty* to = image.certainty.data();
    for (int y = 0; y < cells.height; ++y) {
      judge_flow_row(products.sum_row(y), products.compared(y), cells.width, limits,
                     {row_xx.data(), row_xy.data(), row_yy.data()});
      for (std::size_t x = 0; x < across; ++x, ++to) *to = {row_xx[x], row_xy[x], row_yy[x]};
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
