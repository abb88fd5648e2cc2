// What modules share: waiting for pixels, and keeping exceptions in.
// SPDX-License-Identifier: Apache-2.0
#include "vision/pipeline.h"

#include <exception>
#include <future>
#include <string>

namespace kaz::vision {

Result<std::shared_ptr<const StereoImages>> wait_for_images(const StereoPair& pair,
                                                            std::stop_token stop) {
  if (!pair.images.valid()) {
    return fail(Fault::environment, "a stereo pair came without pixels: check the camera");
  }
  while (pair.images.wait_for(std::chrono::milliseconds(5)) == std::future_status::timeout) {
    if (stop.stop_requested()) return fail(Fault::environment, "vision was stopped");
  }
  try {
    std::shared_ptr<const StereoImages> images = pair.images.get();
    if (images == nullptr) {
      return fail(Fault::environment, "a stereo pair came with empty pixels: check the camera");
    }
    return images;
  } catch (const std::exception& e) {
    return fail(Fault::environment, std::string("the camera gave up on a stereo pair (") +
                                        e.what() + "): start it again");
  }
}

Result<void> run_guarded(const char* module, const std::function<void()>& f) {
  try {
    f();
    return {};
  } catch (const std::exception& e) {
    return fail(Fault::failed, std::string(module) + " failed on a picture: " + e.what());
  } catch (...) {
    return fail(Fault::failed, std::string(module) + " failed on a picture for an unknown reason");
  }
}

}  // namespace kaz::vision
