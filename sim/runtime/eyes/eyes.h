// Simulated stereo camera: schedules exposures, starts their rendering, delivers picture pairs to the host.
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

// Contents of camera.json: camera model and timing. The poses of the cameras are links of the URDF.
struct CameraFile {
  EyeModel eye;
  // Number of the camera pair in its production series. The number determines how the pair deviates from the
  // nominal model.
  std::uint64_t unit = 1;
  double baseline_m = 0.040;  // Simulation replaces this value by the baseline of the URDF
  double rate_hz = 30.0;
  double latency_s = 0.015;  // from the middle of the exposure to the pair's arrival at the host
  double jitter_s = 0;       // maximum additional delay, uniformly distributed
  // True: exactly parallel pinhole cameras without noise. False: lens and sensor of EyeModel; the host
  // receives pictures that were rectified with calibration().
  bool ideal = true;

  // Reads camera.json. Returns Fault::usage if the file is missing or invalid.
  static Result<CameraFile> load(const std::string& path);
  // Pinhole model of the pictures that the host receives.
  Pinhole pinhole() const;
  vision::CameraModel model() const;
  vision::StereoCalibration calibration() const;
};

// Returns "width height fx fy cx cy baseline_m latency_s" of the rectified pictures, with all digits of each
// number. The text is metadata of a recording with pictures.
std::string text_of(const CameraFile& camera);

// Policy if rendering is slower than the world.
enum class FramePolicy {
  wait,  // lockstep: the world waits for the picture, so the result does not depend on the machine
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

  // Selects the data that the recording stores for each pair.
  enum class Keep { nothing, digests, pictures };
  struct Kept {
    std::string left, right;                        // picture_digest() of the RGB bytes
    std::vector<std::uint8_t> left_png, right_png;  // empty unless pictures are kept
  };
  struct Digest {
    std::uint64_t sequence = 0;
    Time exposure{}, arrival{};  // arrival: earliest time at which the host can take the pair
    Kept kept;                   // empty if rendering failed
  };

  // `draws` must outlive this object. `seed` determines image noise and jitter.
  Eyes(RenderThread& draws, const CameraFile& camera, const Mounting& mounting, FramePolicy policy,
       Keep keep, std::uint64_t seed = 1);

  // Exposes a pair if an exposure is due; call this function at the end of each step. Exposure n is due at
  // the step nearest to n / rate. Calls `pose` only for an exposure. Returns the error if an earlier
  // rendering has failed.
  Result<void> look(Time now, const std::function<ScenePose()>& pose);
  // Removes and returns the next pair that has reached the host by `now`. At most 8 pairs wait. If another
  // pair arrives, the oldest waiting pair is dropped.
  std::optional<vision::StereoPair> next_pair(Time now);
  // Returns the number of pairs dropped because of FramePolicy::drop.
  std::uint64_t left_out() const { return left_out_; }

  // Removes and returns the digests of pairs exposed at least two exposures ago; with `all`, the digests of
  // all pairs. Blocks until these pairs are rendered, so the number of digests depends only on simulated
  // time.
  std::vector<Digest> take_digests(bool all);
  // Waits until all pairs in progress are rendered. Noise and jitter then continue with another seed.
  void reseed(std::uint64_t seed);
  // Selects what is stored for pairs exposed from now on.
  void keep(Keep what) { keep_ = what; }

  // Saves or restores the state, including the pixels of waiting pairs (eyes_state.cpp). Saving waits until
  // all pairs in progress are rendered.
  void transfer(StateWriter& a);
  void transfer(StateReader& a);

 private:
  // Lens, sensor and rectification of both eyes. Shared with the rendering jobs; only one rendering job runs
  // at a time.
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
  std::shared_ptr<Optics> optics_;  // null for ideal eyes
  std::uint64_t sequence_ = 0, left_out_ = 0;
  std::deque<std::shared_future<Drawn>> under_way_;
  std::deque<std::pair<Time, vision::StereoPair>> arriving_;  // pairs with their arrival times
  std::deque<Exposed> to_digest_;
};

}  // namespace kaz::sim
