// Observer of the messages written to the recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/time.hpp"
#include "sim/runtime/formats/mcap_writer.h"

namespace kaz::sim {

// Implementations must not change the run.
class RecordingTap : public MessageTap {
 public:
  // Called in each step after all messages of the step. The argument is the time at which the step ended.
  virtual void stepped(Time /*time*/) {}
};

}  // namespace kaz::sim
