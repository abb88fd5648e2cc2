// Runs each vision module on a thread of its own, and delivers results and frames to subscribers.
// SPDX-License-Identifier: Apache-2.0
//
// As in the paper (section 4.1), a module broadcasts its result and the frame information to dependent
// modules. A pipeline runs at one of two paces.
// - Lockstep: every frame is processed. In simulated time, the delay from the arrival of a module's inputs
//   to the delivery of the module's result is exactly the module's declared latency. Repeating a run gives
//   the same results at the same times.
// - Real time: each result is delivered as soon as the result is computed. If frames arrive while a module
//   is busy, the module continues with the newest frame. The module drops and counts the older frames.
//   Dependent modules also drop and count these frames.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "vision/pipeline/module.h"

namespace kaz::vision {

enum class Pace { lockstep, realtime };

struct PipelineOptions {
  Pace pace = Pace::lockstep;
  Time camera_latency{};  // time from exposure to arrival at the host; only used in lockstep
};

// Statistics of one module since the pipeline started.
struct ModuleStatistics {
  std::string name;
  std::uint64_t delivered = 0, failed = 0;
  // Number of frames that this module or a needed module did not process because a newer frame had arrived.
  std::uint64_t dropped = 0;
  // Wall-clock computing time per frame, over the last thousand frames, s.
  double computing_median_s = 0, computing_p95_s = 0, computing_max_s = 0;
  // Time from exposure to delivery of a result, s: simulated time in lockstep, else host time.
  double age_median_s = 0, age_p95_s = 0, age_max_s = 0;
};

// Times of one delivered result, for a log.
struct Delivery {
  std::string_view module;
  std::uint64_t sequence = 0;
  Time exposure{}, delivered{};
  double computing_s = 0;
  bool failed = false;
};

// All calls of a Pipeline must come from one thread. Subscribers are called on the same thread. The
// destructor stops the modules, even if pixels have not arrived yet. Undelivered results are discarded.
class Pipeline {
 public:
  explicit Pipeline(const PipelineOptions& options);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // Adds a module. Call add() before the first submit(). Errors: the name exists already, or a needed module
  // has not been added yet.
  Result<void> add(std::unique_ptr<Module> module);
  bool has(std::string_view module) const;

  // Calls `use(frame, value, error)` for each frame that was not dropped. Exactly one of `value` and `error`
  // is null. Error: no module has this name. If the module's results are not of type T, `use` receives
  // errors.
  template <class T>
  Result<void> subscribe(const std::string& module,
                         std::function<void(const Frame&, const T*, const Error*)> use);
  // Calls `use` for each delivered result.
  void log(std::function<void(const Delivery&)> use);

  // Passes a pair to the modules. Never blocks, even if the pair's pixels are not available yet.
  void submit(StereoPair pair);
  // Delivers all results that are ready, and returns the number of delivered results. In lockstep, poll()
  // waits for results that are due but not yet computed. `now` is host time.
  std::size_t poll(Time now);

  // Waits until all frames are processed, and delivers all results, including results that are not due yet.
  // Use finish() at the end of a stream, and for pictures from files. Blocks forever if the pixels of a pair
  // never arrive.
  std::size_t finish();

  // Returns one entry per module, in the order of add().
  std::vector<ModuleStatistics> statistics() const;

 private:
  using Use = std::function<void(const Frame&, const std::any*, const Error*)>;
  Result<void> subscribe_any(const std::string& module, Use use);
  struct State;
  std::unique_ptr<State> state_;
};

template <class T>
Result<void> Pipeline::subscribe(const std::string& module,
                                 std::function<void(const Frame&, const T*, const Error*)> use) {
  return subscribe_any(module, [module, use = std::move(use)](
                                   const Frame& frame, const std::any* value, const Error* error) {
    const T* typed = std::any_cast<T>(value);
    if (typed != nullptr || error != nullptr) return use(frame, typed, error);
    const Error other{Fault::usage, "results of module '" + module + "' have another type"};
    use(frame, nullptr, &other);
  });
}

}  // namespace kaz::vision
