// Example of a module: brightness of pictures. Linked from docs/explanation/vision.md.
// SPDX-License-Identifier: Apache-2.0
#include "vision/pipeline/brightness_example.h"

#include <numeric>

namespace kaz::vision {

namespace {

double mean(const Image& image) {
  const double sum = std::accumulate(image.rgb.begin(), image.rgb.end(), 0.0);
  return sum / static_cast<double>(image.rgb.size());
}

class BrightnessModule final : public Module {
 public:
  std::string name() const override { return "brightness"; }
  Time latency() const override { return std::chrono::milliseconds(1); }
  Result<std::any> look(const Frame& frame) override {
    const StereoImages& pair = frame.images();
    if (pair.left.rgb.empty() || pair.right.rgb.empty())
      return fail(Fault::usage, "brightness: an eye's picture is empty: check the camera");
    return std::any(Brightness{mean(pair.left), mean(pair.right)});
  }
};

}  // namespace

std::unique_ptr<Module> make_brightness_module() {
  return std::make_unique<BrightnessModule>();
}

}  // namespace kaz::vision
