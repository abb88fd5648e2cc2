// `kaz replay --video`: a film of a recorded run, drawn from its poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct FilmOptions {
  std::string recording;  // file
  std::string path;       // of the film; its ending names the format: .mp4, .webm, .webp, .gif
  double pace = 1;        // seconds of the recording in one of the film
  int fps = 0;            // pictures a second; 0: the format's default
  bool json = false;
};

// An onlooker's view of robot, ball and world; in a corner the left eye's picture, as recorded or else drawn
// from its pose; the time and the behavior's phase. Equal recordings give equal pictures. Nothing is
// simulated. Prints the result. Without success no file is left. Errors:
// - usage: the recording (recorded_poses.h, recorded_backend.h, a damaged chunk); another ending; a film of
//   more than 100,000 pictures
// - environment: ffmpeg is missing or fails; the disk is full
// - interrupted
Result<void> make_film(const FilmOptions& options);

}  // namespace kaz::tools
