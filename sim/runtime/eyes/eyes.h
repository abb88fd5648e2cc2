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
#include "sim/render/sensor/real_eye.h"
#include "sim/runtime/eyes/render_thread.h"
#include "vision/calibration/calibration.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// Contents of camera.json: camera model and timing. The poses of the cameras are links of the URDF.
struct CameraFile {
  EyeModel eye;
  // Number of the camera pair in the production series. The number determines how this camera pair deviates
  // from the nominal camera model.
  std::uint64_t unit = 1;
  // Distance between the eyes. The class Simulation replaces this value by the distance in the URDF.
  double baseline_m = 0.040;
  double rate_hz = 30.0;
  // Time from the middle of the exposure until the pair arrives at the host.
  double latency_s = 0.015;
  double jitter_s = 0;  // maximum additional delay, uniformly distributed
  // True: exactly parallel pinhole cameras without noise. False: lens and sensor of EyeModel; the host
  // receives pictures that were rectified with calibration().
  bool ideal = true;

  // Reads camera.json. Returns Fault::usage if the file is missing or invalid.
  static Result<CameraFile> load(const std::string& path);
  // Camera model of the pictures that the host receives.
  vision::CameraModel model() const;
  vision::StereoCalibration calibration() const;
};

// Returns "width height fx fy cx cy baseline_m latency_s" of the rectified pictures, with all digits of each
// number. A recording with pictures contains this text as metadata.
std::string text_of(const CameraFile& camera);

// Determines what happens if rendering is slower than the simulated world.
enum class FramePolicy {
  // Lockstep: the world waits until the picture is rendered, so the result does not depend on the machine.
  wait,
  drop,  // real time: the picture pair is dropped, and the pair's sequence number is skipped
};

class Eyes {
 public:
  struct Mounting {
    int head_frame = 0;  // index into ScenePose::frames
    // Poses of the eyes' optical frames in the head frame.
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
    Time exposure{}, arrival{};  // `arrival`: earliest time at which the host can read the pair
    Kept kept;                   // empty if rendering failed
  };

  // `draws` must outlive this object. `seed` determines image noise and jitter.
  Eyes(RenderThread& draws, const CameraFile& camera, const Mounting& mounting, FramePolicy policy,
       Keep keep, std::uint64_t seed = 1);

  // Exposes a picture pair if an exposure is due. Call this function at the end of each step. Exposure `n` is
  // due at the simulated time `n / rate_hz`, rounded to a whole millisecond. The function calls `pose` only
  // if an exposure is due. If an earlier rendering has failed, the function returns the error of that
  // rendering.
  Result<void> look(Time now, const std::function<ScenePose()>& pose);
  // Removes and returns the next pair that has reached the host by `now`. At most 8 exposed pairs wait for
  // the host. If 8 pairs are waiting at the next exposure, the oldest waiting pair is dropped.
  std::optional<vision::StereoPair> next_pair(Time now);
  // Returns the number of pairs dropped because of FramePolicy::drop.
  std::uint64_t left_out() const { return left_out_; }

  // Removes and returns digests of pairs. If `all` is true, returns the digests of all pairs. If `all` is
  // false, the digests of the two most recent exposures remain for a later call. Before the function returns
  // the digest of a pair, the function waits until this pair is rendered. Therefore the number of digests
  // does not depend on the speed of rendering.
  std::vector<Digest> take_digests(bool all);
  // Waits until all pairs in progress are rendered. After this call, noise and jitter use the new seed.
  void reseed(std::uint64_t seed);
  // Selects the data that is stored for each pair that is exposed from now on.
  void keep(Keep what) { keep_ = what; }

  // Saves or restores the state, including the pixels of waiting pairs (eyes_state.cpp). Saving waits until
  // all pairs in progress are rendered.
  void transfer(StateWriter& a);
  void transfer(StateReader& a);

 private:
  // Lens, sensor and rectification of both eyes. An Optics object is shared with the rendering jobs; only one
  // rendering job runs at a time.
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
  // Returns the arrival time of the pair that is being exposed. `exposure` is the exposure time of this pair.
  Time arrival_time(Time exposure) const;
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
