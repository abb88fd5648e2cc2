// Plays a recording for viewers, at any speed, with pauses and jumps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "sim/runtime/formats/mcap_reader.h"
#include "tools/view/view.h"

namespace kaz::watch {

struct PlayOptions {
  ViewOptions view;                                 // pace: initial speed; 0: 1
  std::function<void(const std::string&)> on_open;  // called with the page's address; may be null
};

// Returns the text that the page shows until a picture arrives. If the recording has none, it says how to
// record some. Names in the recording that are longer than 64 bytes are left out.
std::string no_pictures_text(const sim::McapRecording& recording);

// Plays until PlayOptions::view.stopped returns true. Errors: those of open_server() (view.h).
Result<void> play(const sim::McapRecording& recording, const PlayOptions& options);

}  // namespace kaz::watch
