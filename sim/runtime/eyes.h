// The stereo pair of eyes: when they expose, who draws, and when a pair reaches the host.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "shared/base/result.hpp"
#include "sim/body/world.h"
#include "sim/runtime/render_thread.h"
#include "sim/view/renderer.h"
#include "vision/frame.h"

namespace kaz::sim {

// camera.json: size, view, base line and timing of the eyes. Their places are links of the URDF.
struct CameraFile {
  int width = 320, height = 240;
  double horizontal_view_rad = 1.3962634015954636;  // 80 degrees
  double baseline_m = 0.040;
  double rate_hz = 30.0;
  double latency_s = 0.015;  // from the middle of the exposure to when the pair reaches the host

  static Result<CameraFile> load(const std::string& path);
  Pinhole pinhole() const;
  vision::CameraModel model() const;
};

// What happens when drawing does not keep up with the world.
enum class FramePolicy {
  wait,  // lockstep: the world waits, so that the outcome does not depend on the machine
  drop,  // real time: the pair is left out, its number is skipped
};

class Eyes {
 public:
  struct Mounting {
    int head_frame = 0;  // index into ScenePose::frames
    // Optical frames in that frame.
    Eigen::Isometry3d left = Eigen::Isometry3d::Identity(), right = Eigen::Isometry3d::Identity();
  };

  // SHA-256 of the bytes of both pictures, for the recording.
  struct Digest {
    std::uint64_t sequence = 0;
    Time exposure{};
    std::string left, right;  // 64 hexadecimal digits each; empty if drawing failed
  };

  // `draws` must outlive the eyes. With `digests` the pictures are hashed as well.
  Eyes(RenderThread& draws, const CameraFile& camera, const Mounting& mounting, FramePolicy policy,
       bool digests);

  // To be called at the end of each step; exposes if one is due. Exposure n is made at the step
  // next to n / rate after time 0. `pose` is asked only then. Error: drawing failed earlier.
  Result<void> look(Time now, const std::function<ScenePose()>& pose);
  // The next pair that has reached the host by `now`. At most 8 are kept for a host that does not
  // take them.
  std::optional<vision::StereoPair> next_pair(Time now);
  std::uint64_t left_out() const { return left_out_; }

  // Digests of pairs exposed at least two exposures ago (all, if `all`), waiting for their drawing:
  // the number returned depends on simulated time alone.
  std::vector<Digest> take_digests(bool all);

 private:
  struct Drawn {
    std::shared_ptr<const vision::StereoImages> images;
    std::string left_digest, right_digest;
  };
  struct Exposed {
    std::uint64_t sequence;
    Time exposure;
    std::shared_future<Drawn> drawn;
  };

  Time exposure_time(std::uint64_t sequence) const;
  void expose(Time now, ScenePose pose);

  RenderThread& draws_;
  CameraFile camera_;
  vision::CameraModel model_;
  Mounting mounting_;
  FramePolicy policy_;
  bool digests_;
  std::uint64_t sequence_ = 0, left_out_ = 0;
  std::deque<std::shared_future<Drawn>> under_way_;
  std::deque<std::pair<Time, vision::StereoPair>> arriving_;  // with the time of arrival
  std::deque<Exposed> to_digest_;
};

}  // namespace kaz::sim
