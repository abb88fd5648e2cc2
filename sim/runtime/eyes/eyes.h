// Stereo camera: exposure times, rendering in another thread, delivery of pairs to the host.
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
#include <vector>

#include "shared/base/archive.hpp"
#include "shared/base/result.hpp"
#include "sim/body/world/world.h"
#include "sim/runtime/eyes/render_thread.h"
#include "sim/view/sensor/real_eye.h"
#include "vision/calibration/calibration.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// Contents of camera.json: camera model and timing. The cameras' poses are links of the URDF.
struct CameraFile {
  EyeModel eye;
  std::uint64_t unit =
      1;  // which pair of the series; determines its deviations from the nominal model
  double baseline_m = 0.040;  // from the URDF, once there is a world
  double rate_hz = 30.0;
  double latency_s = 0.015;  // from the middle of the exposure to when the pair reaches the host
  double jitter_s = 0;       // max additional delay, uniformly distributed
  // True: exactly parallel pinholes without noise. False: lens and sensor of EyeModel; the host gets pictures
  // rectified with the calibration.
  bool ideal = true;

  static Result<CameraFile> load(const std::string& path);
  // Pinhole of the pictures that the host gets.
  Pinhole pinhole() const;
  vision::CameraModel model() const;
  vision::StereoCalibration calibration() const;
};

// For a recording with pictures: "width height fx fy cx cy baseline_m latency_s" of the rectified
// pictures, with all digits.
std::string text_of(const CameraFile& camera);

// Policy if rendering does not keep up with the world.
enum class FramePolicy {
  wait,  // lockstep: the world waits, so the result does not depend on the machine
  drop,  // real time: the pair is dropped, its sequence number is skipped
};

class Eyes {
 public:
  struct Mounting {
    int head_frame = 0;  // index into ScenePose::frames
    // Optical frames in that frame.
    Eigen::Isometry3d left = Eigen::Isometry3d::Identity(), right = Eigen::Isometry3d::Identity();
    Light light = {};  // of the world
  };

  // What the recording stores of each pair.
  enum class Keep { nothing, digests, pictures };
  struct Kept {
    std::string left, right;                        // picture_digest() of the RGB bytes
    std::vector<std::uint8_t> left_png, right_png;  // empty unless pictures are kept
  };
  struct Digest {
    std::uint64_t sequence = 0;
    Time exposure{}, arrival{};  // arrival: earliest time at which the host can take it
    Kept kept;                   // all empty if drawing failed
  };

  // `draws` must outlive the eyes. `seed`: for image noise and jitter.
  Eyes(RenderThread& draws, const CameraFile& camera, const Mounting& mounting, FramePolicy policy,
       Keep keep, std::uint64_t seed = 1);

  // To be called at the end of each step; exposes if an exposure is due. Exposure n is at the step nearest to
  // n / rate. `pose` is called only then. Error: rendering failed earlier.
  Result<void> look(Time now, const std::function<ScenePose()>& pose);
  // The next pair that has reached the host by `now`. At most 8 are kept; then the oldest is dropped.
  std::optional<vision::StereoPair> next_pair(Time now);
  std::uint64_t left_out() const { return left_out_; }

  // Digests of pairs exposed at least two exposures ago (all, if `all`); blocks until they are rendered, so
  // that the number returned depends on simulated time only.
  std::vector<Digest> take_digests(bool all);
  // Goes on with the noise and jitter of another seed, once the pairs under way are drawn.
  void reseed(std::uint64_t seed);
  // Whether pictures are stored with their digests, for pairs exposed from now on.
  void keep(Keep what) { keep_ = what; }

  // Waits for pairs being rendered and saves their pixels (eyes_state.cpp).
  void transfer(StateWriter& a);
  void transfer(StateReader& a);

 private:
  // Lens, sensor and rectification of both eyes, shared with the rendering jobs, of which one is at work at a
  // time.
  struct Optics {
    Optics(const CameraFile& camera, std::uint64_t seed);
    RealEye left, right;
  };
  struct Drawn {
    std::shared_ptr<const vision::StereoImages> images;
    Kept kept;
  };
  struct Exposed {
    std::uint64_t sequence;
    Time exposure, arrival;
    std::shared_future<Drawn> drawn;
  };

  static Result<void> draw(Renderer& renderer, const ScenePose& pose, const View& left,
                           const View& right, Optics* optics, std::uint64_t sequence,
                           vision::StereoImages& pair);
  static Result<Kept> kept_of(const vision::StereoImages& pair, Keep keep);
  Time exposure_time(std::uint64_t sequence) const;
  Time arrival_time(Time exposure) const;  // of the pair now exposed
  void expose(Time now, ScenePose pose);

  RenderThread& draws_;
  CameraFile camera_;
  vision::CameraModel model_;
  Mounting mounting_;
  FramePolicy policy_;
  Keep keep_;
  std::uint64_t seed_;
  std::shared_ptr<Optics> optics_;  // null: ideal
  std::uint64_t sequence_ = 0, left_out_ = 0;
  std::deque<std::shared_future<Drawn>> under_way_;
  std::deque<std::pair<Time, vision::StereoPair>> arriving_;  // with the time of arrival
  std::deque<Exposed> to_digest_;
};

}  // namespace kaz::sim
