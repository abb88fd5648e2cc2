// Plays a recording for viewers: in its own time, faster or slower, with pauses and jumps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "sim/runtime/formats/mcap_reader.h"
#include "tools/view/view.h"

namespace kaz::watch {

struct PlayOptions {
  ViewOptions view;                                 // pace: the speed at which it begins; 0: 1
  std::function<void(const std::string&)> on_open;  // the page's address
};

// What the page shows until a picture comes: if the recording holds none, how to record some. Names of the
// recording that are longer than 64 bytes are left out.
std::string no_pictures_text(const sim::McapRecording& recording);

// Until PlayOptions::view.stopped. Errors: as View::open().
Result<void> play(const sim::McapRecording& recording, const PlayOptions& options);

}  // namespace kaz::watch
