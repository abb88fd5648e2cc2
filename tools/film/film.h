// `kaz replay --video`: draws a film of a recorded run from its poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct FilmOptions {
  std::string recording;  // path of the recording
  std::string path;  // path of the film; the ending selects the format: .mp4, .webm, .webp, .gif
  double pace = 1;   // seconds of the recording per second of the film
  int fps = 0;       // pictures per second of the film; 0: the format's default
  bool json = false;
};

// Draws an external view of robot, ball and world, with the time and the behavior's phase. A corner shows the
// left eye's picture: the recorded picture, or else a picture drawn from the eye's pose. Equal recordings
// give equal pictures. Runs no simulation. Prints the result. If make_film() fails, no file is left. Errors:
// - usage: invalid recording (recorded_poses.h, recorded_backend.h, a damaged chunk), unknown ending, or a
//   film of more than 100,000 pictures.
// - environment: ffmpeg is missing or failed, or the disk is full.
// - interrupted: a signal was received.
Result<void> make_film(const FilmOptions& options);

}  // namespace kaz::tools
