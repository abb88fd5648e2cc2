// Interface of a vision module, and the frame that it processes.
// SPDX-License-Identifier: Apache-2.0
//
// A module computes one result from a stereo pair, and from the results of other modules for the same pair. A
// Frame contains the pair, the results and the frame information (frame.h), so the inputs of a module always
// belong to one frame. Your own modules implement the same interface as the modules of modules.h. A pipeline
// (pipeline.h) runs the modules.
#pragma once

#include <any>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"

namespace kaz::vision {

class Frame {
 public:
  const FrameInfo& info() const { return pair_.info; }
  // Returns true for the first frame, for the first frame after a gap in the sequence, and if the camera's
  // clock stepped back. A module that compares successive frames must start again if after_gap() is true.
  bool after_gap() const { return after_gap_; }
  // The rectified pictures. Modules may call images() in look(). Subscribers may call images() if they
  // receive a value, not an error.
  const StereoImages& images() const { return *images_; }
  std::shared_ptr<const StereoImages> shared_images() const { return images_; }

  // Returns the result of `module` for this frame. Module::look() may read the results of the modules in
  // needs(). A subscriber may read the result of the module to which it subscribed. A subscriber may also
  // read the results that this module needs. Throws std::logic_error if the result does not exist or is not a
  // T.
  template <class T>
  const T& of(std::string_view module) const {
    const T* value = std::any_cast<T>(find(module));
    if (value == nullptr)
      throw std::logic_error(
          "module '" + std::string(module) +
          "' has no result of the requested type for this frame: add the module to needs()");
    return *value;
  }

 private:
  friend class Pipeline;
  struct Slot {
    enum class State { waiting, done, failed, dropped };
    State state = State::waiting;
    std::any value;              // result; set in the state `done`
    std::optional<Error> error;  // set in the state `failed`
    int missing = 0;             // number of needed results that are not yet available
    double computing_s = 0;      // wall-clock time
  };
  using Names = std::map<std::string, std::size_t, std::less<>>;

  const std::any* find(std::string_view module) const {
    const auto at = names_->find(module);
    if (at == names_->end()) return nullptr;
    const Slot& slot = slots_[at->second];
    return slot.state == Slot::State::done ? &slot.value : nullptr;
  }

  StereoPair pair_;
  bool after_gap_ = false;
  std::shared_ptr<const StereoImages> images_;
  std::shared_ptr<const Names> names_;
  std::vector<Slot> slots_;  // one slot per module
};

class Module {
 public:
  virtual ~Module() = default;
  // Short name in lower case; unique in a pipeline.
  virtual std::string name() const = 0;
  // Names of the modules whose results look() reads.
  virtual std::vector<std::string> needs() const { return {}; }
  // Declared latency, only used in lockstep: the simulated time from the arrival of the module's inputs to
  // the delivery of the module's result. The latency counts from the delivery of the last needed result. For
  // a module that needs no results, the latency counts from the arrival of the pair. The real computing time
  // has no effect.
  virtual Time latency() const = 0;
  // Processes one frame. The pipeline calls look() on the module's own thread for one frame at a time, in
  // order of arrival. The type of the result must be copyable and the same for all frames. If look() returns
  // an error, subscribers receive the error in place of the result, and dependent modules fail for this
  // frame. An exception from look() counts as an error.
  virtual Result<std::any> look(const Frame& frame) = 0;
};

}  // namespace kaz::vision
