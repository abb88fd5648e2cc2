// Dense flow: OpenCV's inverse search (DIS), and validation of its result.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "vision/flow/flow_cells.h"
#include "vision/flow/flow_pair.h"
#include "vision/flow/flow_scale.h"
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

constexpr int kFinestScale = 2;  // of the ultrafast preset: pictures are halved twice
static_assert(1 << kFinestScale == kSmall);

// The number of the coarsest scale that the search takes for pictures of this size: displacements up to a
// quarter of the longer side, and the shorter side not below a patch of 8.
int coarsest_scale(cv::Size size) {
  const int longer = std::max(size.width, size.height),
            shorter = std::min(size.width, size.height) / 8;
  return std::min(static_cast<int>(std::log(longer / 32.0) / std::log(2.0) + 0.5),
                  static_cast<int>(std::log(shorter) / std::log(2.0)));
}

// Whether the search on pictures that are already small begins at the same scale.
bool starts_small(cv::Size size) {
  const cv::Size small(size.width / kSmall, size.height / kSmall);
  return size.width % kSmall == 0 && size.height % kSmall == 0 && small.width >= 16 &&
         small.height >= 16 && coarsest_scale(small) >= 0 &&
         coarsest_scale(small) == coarsest_scale(size) - kFinestScale;
}

}  // namespace

struct FlowFinder::State {
  FlowOptions options;
  cv::Ptr<cv::DISOpticalFlow> search;
  cv::Size searched;  // the search fits its scales to the first pictures' size
  bool small_search = false;
  cv::Mat grey[2], small8[2], small[2];  // of the earlier and the later picture
  bool prepared = false;                 // the later one's are there
  cv::Mat found;                         // flow of the search
  FlowEnlarger enlarger;
  FlowProducts products;
  std::vector<int> middle_column;             // of small pixels, in the full picture
  std::vector<float> there, compared;         // of a row: see FlowProducts::set_row()
  std::vector<float> row_xx, row_xy, row_yy;  // certainty of a row

  Result<void> find(const ImageView& before, const FrameInfo& info_before, const ImageView& after,
                    const FrameInfo& info_after, bool continued, FlowImage& image) {
    image.before = info_before;
    image.after = info_after;
    const bool reuse = continued && std::exchange(prepared, false);
    if (auto ok = check_options(options); !ok) return ok;
    if (auto ok = check_flow_pair(before, info_before, after, info_after); !ok) return ok;
    image.width = before.width;
    image.height = before.height;
    image.flow_px.resize(static_cast<std::size_t>(before.width) *
                         static_cast<std::size_t>(before.height));
    try {
      const OpenCvQuiet quiet;
      begin({before.width, before.height});
      if (reuse && small8[1].size() == small_size()) {
        std::swap(small8[0], small8[1]);
        std::swap(small[0], small[1]);
        std::swap(grey[0], grey[1]);
      } else {
        prepare(before, 0);
      }
      prepare(after, 1);
      compute(image);
      prepared = true;
    } catch (const cv::Exception& e) {
      return fail(Fault::failed, std::string("flow: OpenCV failed: ") + e.what());
    }
    return {};
  }

  cv::Size small_size() const { return {searched.width / kSmall, searched.height / kSmall}; }

  // The search halves the pictures to its finest scale and enlarges its flow from there. Where it takes the
  // same scales for pictures that are small already, it is given those, and both is done here, once a
  // picture.
  void begin(cv::Size size) {
    if (search && searched == size) return;
    search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST);
    searched = size;
    small_search = starts_small(size);
    if (small_search) search->setFinestScale(0);
    const cv::Size small_picture = small_size();
    enlarger.resize({small_picture.width, small_picture.height}, {size.width, size.height});
  }

  void prepare(const ImageView& picture, int side) {
    const cv::Mat full = flow_grey(picture, grey[side]);
    const cv::Size size = small_size();
    if (small_search) {
      small8[side].create(size, CV_8UC1);
      quarter(full.data, full.cols, full.rows, small8[side].data);
    } else {
      cv::resize(full, small8[side], size, 0, 0, cv::INTER_AREA);
      full.copyTo(grey[side]);
    }
    small8[side].convertTo(small[side], CV_32F);
  }

  void compute(FlowImage& image) {
    found.release();  // otherwise it would be the initial estimate
    auto* const to = reinterpret_cast<float*>(image.flow_px.data());
    if (small_search) {
      search->calc(small8[0], small8[1], found);
      enlarger.enlarge(found.ptr<float>(), kSmall, to);
    } else {
      search->calc(grey[0], grey[1], found);
      std::copy_n(found.ptr<float>(), 2 * image.flow_px.size(), to);
    }
    compare(image);
    judge(image);
    mark(image);
  }

  // Middle of a small pixel in the full picture.
  static int middle(int small_pixel, int small_pixels, int pixels) {
    return std::min((2 * small_pixel + 1) * pixels / (2 * small_pixels), pixels - 1);
  }

  // Brightness of the later small picture along the flow, for each pixel of the earlier one.
  void compare(const FlowImage& image) {
    const cv::Mat &a = small[0], &b = small[1];
    const auto columns = static_cast<std::size_t>(a.cols);
    products.resize(a.cols, a.rows);
    middle_column.resize(columns);
    for (int x = 0; x < a.cols; ++x)
      middle_column[static_cast<std::size_t>(x)] = middle(x, a.cols, image.width);
    there.assign(columns, 0);
    compared.assign(columns, 0);
    const float per_x = static_cast<float>(a.cols) / static_cast<float>(image.width);
    const float per_y = static_cast<float>(a.rows) / static_cast<float>(image.height);
    for (int y = 1; y + 1 < a.rows; ++y) {
      const Eigen::Vector2f* flows = &image.at(0, middle(y, a.rows, image.height));
      for (int x = 1; x + 1 < a.cols; ++x) {
        const auto k = static_cast<std::size_t>(x);
        const Eigen::Vector2f& f = flows[middle_column[k]];
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

  // Sets the flow to NaN in the cells that are not valid.
  void mark(FlowImage& image) const {
    const auto width = static_cast<std::size_t>(image.width);
    for (int v = 0; v < image.height; ++v) {
      Eigen::Vector2f* to = &image.flow_px[static_cast<std::size_t>(v) * width];
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
                              const FrameInfo& info_after, FlowImage& flow, bool continued) {
  return state_->find(image_view(before), info_before, image_view(after), info_after, continued,
                      flow);
}
Result<void> FlowFinder::find(const GreyPicture& before, const FrameInfo& info_before,
                              const GreyPicture& after, const FrameInfo& info_after,
                              FlowImage& flow) {
  return state_->find(image_view(before), info_before, image_view(after), info_after, false, flow);
}

}  // namespace kaz::vision
