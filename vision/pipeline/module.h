// What a module of vision is, and the frame that it looks at.
// SPDX-License-Identifier: Apache-2.0
//
// A module takes a stereo pair, and results of other modules on the same pair, and makes a result
// of its own. The frame carries all of them together with the frame information (frame.h): what one
// module sees of a frame is of that frame and no other. Own modules are written like those of
// modules.h; a pipeline (pipeline.h) runs them.
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
  // True for the first frame, and where the camera left pairs out before this one or its clock
  // stepped back: what compares frames has to begin anew.
  bool after_gap() const { return after_gap_; }
  // Rectified. There in look(), and in a subscriber whose result is there.
  const StereoImages& images() const { return *images_; }
  std::shared_ptr<const StereoImages> shared_images() const { return images_; }

  // What `module` made of this frame. For modules named in needs(), and for subscribers those that
  // the module they subscribed to needs. Throws where there is no such result or it is no T.
  template <class T>
  const T& of(std::string_view module) const {
    const T* value = std::any_cast<T>(find(module));
    if (value == nullptr)
      throw std::logic_error("no result of the requested type of module '" + std::string(module) +
                             "' on this frame: is it among those needed?");
    return *value;
  }

 private:
  friend class Pipeline;
  struct Slot {
    enum class State { waiting, done, failed, dropped };
    State state = State::waiting;
    std::any value;              // where done
    std::optional<Error> error;  // where failed
    int missing = 0;             // needed results that are not there yet
    double computing_s = 0;      // wall clock
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
  std::vector<Slot> slots_;  // by module
};

class Module {
 public:
  virtual ~Module() = default;
  // Short, in lower case; unique in a pipeline.
  virtual std::string name() const = 0;
  // Modules whose results it looks at.
  virtual std::vector<std::string> needs() const { return {}; }
  // In lockstep its result is there so long after the last of what it needs (or after the pair's
  // arrival), in simulated time, however long the computer takes.
  virtual Time latency() const = 0;
  // On the module's own thread; one frame at a time, by rising time of arrival. The result is any
  // copyable type, the same each time. An error goes to subscribers, and to the modules that need
  // this one, in place of the result. Exceptions are turned into errors.
  virtual Result<std::any> look(const Frame& frame) = 0;
};

}  // namespace kaz::vision
