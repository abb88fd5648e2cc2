// Saves and restores the eyes' state.
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "sim/runtime/eyes/eyes.h"

namespace kaz::sim {
namespace {

constexpr std::uint64_t kMaxSequence = std::uint64_t{1} << 40;  // 69 years at 500 Hz

template <class T>
std::shared_future<T> ready(T value) {
  std::promise<T> promise;
  promise.set_value(std::move(value));
  return promise.get_future().share();
}

template <class A>
void transfer_image(A& a, vision::Image& image) {
  a(image.width, image.height, image.rgb);
}

bool is_of(const vision::CameraModel& camera, const vision::Image& image) {
  return image.width == camera.width && image.height == camera.height &&
         image.rgb.size() == 3 * static_cast<std::size_t>(image.width) *
                                 static_cast<std::size_t>(image.height);
}

template <class A>
void transfer_kept(A& a, auto& exposed, Eyes::Kept& kept) {
  a(exposed.sequence, exposed.exposure, exposed.arrival, kept.left, kept.right, kept.left_png,
    kept.right_png);
}

}  // namespace

void Eyes::transfer(StateWriter& a) {
  a(sequence_, left_out_);
  auto arriving = static_cast<std::uint64_t>(arriving_.size());
  a(arriving);
  for (auto& [at, pair] : arriving_) {
    vision::StereoImages images = *pair.images.get();
    a(at, pair.info.sequence, pair.info.exposure);
    transfer_image(a, images.left);
    transfer_image(a, images.right);
  }
  auto digests = static_cast<std::uint64_t>(to_digest_.size());
  a(digests);
  for (Exposed& exposed : to_digest_) {
    Drawn drawn = exposed.drawn.get();
    transfer_kept(a, exposed, drawn.kept);
  }
}

void Eyes::transfer(StateReader& a) {
  a(sequence_, left_out_);
  a.require(sequence_ <= kMaxSequence, "picture number");
  std::uint64_t arriving = 0, digests = 0;
  under_way_.clear();
  arriving_.clear();
  to_digest_.clear();
  a(arriving);
  for (std::uint64_t k = 0; k < arriving && a.good(); ++k) {
    Time at{};
    vision::StereoPair pair;
    auto images = std::make_shared<vision::StereoImages>();
    a(at, pair.info.sequence, pair.info.exposure);
    transfer_image(a, images->left);
    transfer_image(a, images->right);
    if (!a.require(is_of(model_, images->left) && is_of(model_, images->right), "picture")) return;
    pair.info.camera = model_;
    pair.images = ready<std::shared_ptr<const vision::StereoImages>>(std::move(images));
    arriving_.emplace_back(at, std::move(pair));
  }
  a(digests);
  for (std::uint64_t k = 0; k < digests && a.good(); ++k) {
    Exposed exposed;
    Drawn drawn;
    transfer_kept(a, exposed, drawn.kept);
    exposed.drawn = ready(std::move(drawn));
    to_digest_.push_back(std::move(exposed));
  }
}

}  // namespace kaz::sim
