// Exposures on the step grid, drawn by the render thread, delivered by simulated time.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/eyes/eyes.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "shared/base/profile.hpp"
#include "shared/base/random.hpp"
#include "sim/runtime/formats/picture_digest.h"
#include "sim/runtime/formats/png_picture.h"

namespace kaz::sim {
namespace {

constexpr std::size_t kMaxUnderWay = 3;  // rendering jobs in flight
constexpr std::size_t kMaxKept = 8;      // pairs queued for the host

// Delivered if rendering failed; the simulation's next step returns the error.
vision::Image black(const vision::CameraModel& camera) {
  const auto bytes = static_cast<std::size_t>(camera.width) * camera.height * 3;
  return {camera.width, camera.height, std::vector<std::uint8_t>(bytes)};
}

bool done(const auto& future) {
  return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

Eyes::Eyes(RenderThread& draws, const CameraFile& camera, const Mounting& mounting,
           FramePolicy policy, Keep keep, std::uint64_t seed)
    : draws_(draws),
      camera_(camera),
      model_(camera.model()),
      mounting_(mounting),
      policy_(policy),
      keep_(keep),
      seed_(seed) {
  if (!camera.ideal) optics_ = std::make_shared<Optics>(camera, seed);
}

void Eyes::reseed(std::uint64_t seed) {
  for (const auto& drawn : under_way_) drawn.wait();
  seed_ = seed;
  if (!optics_) return;
  optics_->left.set_noise_seed(seed);
  optics_->right.set_noise_seed(seed);
}

Eyes::Optics::Optics(const CameraFile& camera, std::uint64_t seed)
    : left(camera.eye, camera.calibration(), Sensor::Eye::left, seed),
      right(camera.eye, camera.calibration(), Sensor::Eye::right, seed) {}

Time Eyes::exposure_time(std::uint64_t sequence) const {
  const double ms = std::round(1000.0 * static_cast<double>(sequence) / camera_.rate_hz);
  return std::chrono::milliseconds(static_cast<std::int64_t>(ms));
}

// Delay by bus slots and the host's scheduling: latency plus uniform jitter.
Time Eyes::arrival_time(Time exposure) const {
  const double share = static_cast<double>(mix64(mix64(seed_) ^ sequence_) >> 11) * 0x1p-53;
  return exposure + from_seconds(camera_.latency_s + share * camera_.jitter_s);
}

Result<void> Eyes::draw(Renderer& renderer, const ScenePose& pose, const View& left,
                        const View& right, Optics* optics, std::uint64_t sequence,
                        vision::StereoImages& pair) {
  if (optics != nullptr) {
    KAZ_TRY(optics->left.take(renderer, pose, left, sequence, pair.left));
    return optics->right.take(renderer, pose, right, sequence, pair.right);
  }
  const ProfileScope part("drawing");
  KAZ_TRY(renderer.render(pose, left, pair.left));
  return renderer.render(pose, right, pair.right);
}

Result<Eyes::Kept> Eyes::kept_of(const vision::StereoImages& pair, Keep keep) {
  Kept kept;
  if (keep == Keep::nothing) return kept;
  const ProfileScope recording("digests of pictures");
  kept.left = picture_digest(pair.left.rgb);
  kept.right = picture_digest(pair.right.rgb);
  if (keep == Keep::digests) return kept;
  auto left = encode_png(pair.left), right = encode_png(pair.right);
  if (!left) return tl::unexpected(left.error());
  if (!right) return tl::unexpected(right.error());
  kept.left_png = std::move(*left);
  kept.right_png = std::move(*right);
  return kept;
}

Result<void> Eyes::look(Time now, const std::function<ScenePose()>& pose) {
  if (auto error = draws_.error()) return tl::unexpected(*error);
  while (exposure_time(sequence_) < now) ++sequence_;  // exposures while the eyes were closed
  while (!under_way_.empty() && done(under_way_.front())) under_way_.pop_front();
  if (now < exposure_time(sequence_)) return {};

  if (under_way_.size() >= kMaxUnderWay) {
    if (policy_ == FramePolicy::drop) {
      ++left_out_;
      ++sequence_;
      return {};
    }
    const ProfileScope waiting("waiting for pictures");
    under_way_.front().wait();
    under_way_.pop_front();
  }
  expose(now, pose());
  return {};
}

void Eyes::expose(Time now, ScenePose pose) {
  const Eigen::Isometry3d head = pose.frames[static_cast<std::size_t>(mounting_.head_frame)];
  const Eigen::Isometry3d left_eye = head * mounting_.left, right_eye = head * mounting_.right;
  View left{model_, left_eye}, right{model_, right_eye};
  if (optics_) {
    left = optics_->left.view(left_eye);
    right = optics_->right.view(right_eye);
  }
  left.light = right.light = mounting_.light;

  auto drawn = std::make_shared<std::promise<Drawn>>();
  auto images = std::make_shared<std::promise<std::shared_ptr<const vision::StereoImages>>>();
  draws_.submit([&draws = draws_, left, right, drawn, images, keep = keep_, optics = optics_,
                 size = model_, sequence = sequence_,
                 pose = std::move(pose)](const Result<Renderer*>& renderer) {
    auto pair = std::make_shared<vision::StereoImages>();
    Result<void> result;
    if (renderer) {
      result = draw(**renderer, pose, left, right, optics.get(), sequence, *pair);
    } else {
      result = tl::unexpected(renderer.error());
    }
    Drawn outcome;
    if (result) {
      images->set_value(pair);  // vision can start while the pictures are hashed
      if (auto kept = kept_of(*pair, keep)) {
        outcome.kept = std::move(*kept);
      } else {
        draws.set_error(kept.error());
      }
    } else {
      draws.set_error(result.error());
      pair->left = black(size);
      pair->right = black(size);
      images->set_value(pair);
    }
    outcome.images = pair;
    drawn->set_value(std::move(outcome));
  });

  vision::StereoPair pair;
  pair.info.sequence = sequence_;
  pair.info.exposure = now;
  pair.info.camera = model_;
  pair.images = images->get_future().share();
  const Time arrival = arrival_time(now);
  arriving_.emplace_back(arrival, std::move(pair));
  if (arriving_.size() > kMaxKept) arriving_.pop_front();

  const std::shared_future<Drawn> outcome = drawn->get_future().share();
  under_way_.push_back(outcome);
  if (keep_ != Keep::nothing) to_digest_.push_back({sequence_, now, arrival, outcome});
  ++sequence_;
}

std::optional<vision::StereoPair> Eyes::next_pair(Time now) {
  if (arriving_.empty() || arriving_.front().first > now) return std::nullopt;
  vision::StereoPair pair = std::move(arriving_.front().second);
  arriving_.pop_front();
  return pair;
}

std::vector<Eyes::Digest> Eyes::take_digests(bool all) {
  std::vector<Digest> digests;
  while (!to_digest_.empty() && (all || to_digest_.front().sequence + 2 < sequence_)) {
    const Exposed& exposed = to_digest_.front();
    std::optional<ProfileScope> waiting(std::in_place, "waiting for pictures");
    const Drawn& drawn = exposed.drawn.get();
    waiting.reset();
    digests.push_back({exposed.sequence, exposed.exposure, exposed.arrival, drawn.kept});
    to_digest_.pop_front();
  }
  return digests;
}

}  // namespace kaz::sim
