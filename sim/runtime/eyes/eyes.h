// Simulated stereo camera: schedules exposures, has them rendered and delivers pairs to the host.
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
  // Number of the camera pair in its series. Determines its deviations from the nominal model.
  std::uint64_t unit = 1;
  double baseline_m = 0.040;  // a Simulation replaces it by the URDF's
  double rate_hz = 30.0;
  double latency_s = 0.015;  // from the middle of the exposure to the pair's arrival at the host
  double jitter_s = 0;       // maximum additional delay, uniformly distributed
  // True: exactly parallel pinhole cameras without noise. False: lens and sensor of EyeModel; the host
  // receives pictures rectified with calibration().
  bool ideal = true;

  // Reads camera.json. Returns Fault::usage if the file is missing or invalid.
  static Result<CameraFile> load(const std::string& path);
  // Pinhole of the pictures that the host receives.
  Pinhole pinhole() const;
  vision::CameraModel model() const;
  vision::StereoCalibration calibration() const;
};

// Returns "width height fx fy cx cy baseline_m latency_s" of the rectified pictures with all digits, for the
// metadata of a recording with pictures.
std::string text_of(const CameraFile& camera);

// Policy if rendering falls behind the world.
enum class FramePolicy {
  wait,  // lockstep: the world waits, so the result does not depend on the machine
  drop,  // real time: the pair is dropped and its sequence number skipped
};

class Eyes {
 public:
  struct Mounting {
    int head_frame = 0;  // index into ScenePose::frames
    // Optical frames of the eyes in the head frame.
    Eigen::Isometry3d left = Eigen::Isometry3d::Identity(), right = Eigen::Isometry3d::Identity();
    Light light = {};  // the world's light
  };

  // Content that the recording stores of each pair.
  enum class Keep { nothing, digests, pictures };
  struct Kept {
    std::string left, right;                        // picture_digest() of the RGB bytes
    std::vector<std::uint8_t> left_png, right_png;  // empty unless pictures are kept
  };
  struct Digest {
    std::uint64_t sequence = 0;
    Time exposure{}, arrival{};  // arrival: earliest time at which the host can take it
    Kept kept;                   // empty if rendering failed
  };

  // `draws` must outlive this. `seed` determines image noise and jitter.
  Eyes(RenderThread& draws, const CameraFile& camera, const Mounting& mounting, FramePolicy policy,
       Keep keep, std::uint64_t seed = 1);

  // Exposes a pair if one is due; call it at the end of each step. Exposure n is due at the step nearest to
  // n / rate. Calls `pose` only for an exposure. Returns the error if rendering has failed earlier.
  Result<void> look(Time now, const std::function<ScenePose()>& pose);
  // Removes and returns the next pair that has reached the host by `now`. At most 8 pairs wait; then the
  // oldest is dropped.
  std::optional<vision::StereoPair> next_pair(Time now);
  // Returns the number of pairs that FramePolicy::drop has dropped.
  std::uint64_t left_out() const { return left_out_; }

  // Removes and returns the digests of pairs exposed at least two exposures ago, or of all if `all`. Blocks
  // until they are rendered, so that their number depends only on simulated time.
  std::vector<Digest> take_digests(bool all);
  // Waits for the pairs being rendered, then continues with noise and jitter of another seed.
  void reseed(std::uint64_t seed);
  // Sets the content that is stored of pairs exposed from now on.
  void keep(Keep what) { keep_ = what; }

  // Saves or restores the state, with the pixels of waiting pairs (eyes_state.cpp). Saving waits for pairs
  // being rendered.
  void transfer(StateWriter& a);
  void transfer(StateReader& a);

 private:
  // Lens, sensor and rectification of both eyes. Shared with the rendering jobs, of which only one runs at a
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
  Time arrival_time(Time exposure) const;  // for the pair being exposed
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
  std::deque<std::pair<Time, vision::StereoPair>> arriving_;  // with arrival times
  std::deque<Exposed> to_digest_;
};

}  // namespace kaz::sim
