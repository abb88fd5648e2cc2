// Whoever hears what a recording gets while the run goes on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/runtime/formats/mcap_writer.h"
#include "vision/image/frame.h"  // Time

namespace kaz::sim {

// What it does must not change the run: it reads.
class RecordingTap : public MessageTap {
 public:
  // Behind a step's messages; the step's end.
  virtual void stepped(Time /*time*/) {}
};

}  // namespace kaz::sim
