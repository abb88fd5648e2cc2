// Validation of a camera stream from another process.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/camera_stream.h"

#include <algorithm>

#include "host/link/frame_log.h"
#include "vision/calibration/valid_camera.h"

namespace kaz::host {

Result<CameraStream> parse(const CameraStreamHeader& header, const std::string& path) {
  if (!std::equal(std::begin(kCameraStreamMagic), std::end(kCameraStreamMagic), header.magic)) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(header.magic);
    return fail(
        Fault::environment,
        "the data from " + path + " is not a camera stream: it starts with " + hex({bytes, 4}));
  }
  if (header.version != kCameraStreamVersion) {
    return fail(Fault::environment,
                "the camera stream at " + path + " has version " + std::to_string(header.version) +
                    " and this program reads version " + std::to_string(kCameraStreamVersion) +
                    ": run simulator and program from the same release");
  }
  const auto impossible = [&](const std::string& what) {
    return fail(Fault::environment, "the camera stream at " + path +
                                        " declares an impossible camera (" + what +
                                        "): use a stream of `kaz sim --cameras`");
  };
  const std::string size = std::to_string(header.width) + " x " + std::to_string(header.height);
  if (header.width > kCameraStreamMaxSide || header.height > kCameraStreamMaxSide)
    return impossible(size + " pixels");
  CameraStream stream;
  stream.model.width = static_cast<int>(header.width);
  stream.model.height = static_cast<int>(header.height);
  stream.model.fx = header.fx;
  stream.model.fy = header.fy;
  stream.model.cx = header.cx;
  stream.model.cy = header.cy;
  stream.model.baseline_m = header.baseline_m;
  if (!valid_camera(stream.model))
    return impossible(size + " pixels, focal lengths " + std::to_string(header.fx) + " and " +
                      std::to_string(header.fy) + ", center " + std::to_string(header.cx) + " " +
                      std::to_string(header.cy) + ", baseline " +
                      std::to_string(header.baseline_m) + " m");
  stream.latency = Time(header.latency_ns);
  if (stream.latency < Time(0) || stream.latency > kMaxCameraLatency)
    return impossible("a latency of " + std::to_string(header.latency_ns) + " ns");
  return stream;
}

Result<vision::FrameInfo> parse(const CameraStreamPair& pair, const CameraStream& stream, Time now,
                                const std::string& path) {
  if (!std::equal(std::begin(kCameraPairMagic), std::end(kCameraPairMagic), pair.magic)) {
    return fail(
        Fault::environment,
        "camera " + path +
            " stopped: the data is not a stereo pair; run both programs from the same release");
  }
  vision::FrameInfo info;
  info.sequence = pair.sequence;
  info.exposure = Time(pair.exposure_ns);
  info.camera = stream.model;
  // A pair that never becomes due would block all later ones.
  if (info.exposure < Time(0) || info.exposure > later(now, kMaxCameraAhead)) {
    return fail(Fault::environment, "camera " + path + " stopped: a pair has the exposure time " +
                                        std::to_string(pair.exposure_ns) +
                                        " ns, which is not a valid time on this machine's clock");
  }
  return info;
}

}  // namespace kaz::host
