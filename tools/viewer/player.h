// Plays a recording for viewers, at any speed, with pauses and jumps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "sim/runtime/formats/mcap_reader.h"
#include "tools/viewer/view.h"

namespace kaz::viewer {

struct PlayOptions {
  ViewOptions view;  // view.pace is the initial speed; 0 means a speed of 1
  // Called with the address of the page; may be null.
  std::function<void(const std::string&)> on_open;
};

// Returns the text that the page shows until a picture arrives. If the recording has no pictures, the text
// says how to record pictures. Names in the recording that are longer than 64 bytes are left out.
std::string no_pictures_text(const sim::McapRecording& recording);

// Plays until PlayOptions::view.stopped returns true. Fails like open_server() (view.h).
Result<void> play(const sim::McapRecording& recording, const PlayOptions& options);

}  // namespace kaz::viewer
