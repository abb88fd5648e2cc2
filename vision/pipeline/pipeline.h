// Modules of vision at work: each on its own thread, results delivered to subscribers with the
// frame they are of.
// SPDX-License-Identifier: Apache-2.0
//
// Paper section 4.1: a module broadcasts its result, and the frame information it is of, to those
// that follow. Two paces:
// - lockstep: all frames are looked at, and a result is delivered exactly its declared latency
//   after what it needs, in simulated time. The same run again gives the same results at the same
//   times.
// - real time: a module that is not done when frames come in looks at the newest of them next; older
//   ones are dropped for it and for what needs it, and counted. Results are delivered when done.
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
  Time camera_latency{};  // from exposure to arrival at the host; counts in lockstep
};

// Of one module, since the pipeline began.
struct ModuleStatistics {
  std::string name;
  std::uint64_t delivered = 0, failed = 0;
  std::uint64_t dropped = 0;  // a newer frame came before work on this one began
  // Of the last thousand frames: time the module computed, on the wall clock, s.
  double computing_median_s = 0, computing_p95_s = 0, computing_max_s = 0;
  // The same from exposure to delivery, in the host's time (simulated in lockstep), s.
  double age_median_s = 0, age_p95_s = 0, age_max_s = 0;
};

// One result as it is delivered: times for a log.
struct Delivery {
  std::string_view module;
  std::uint64_t sequence = 0;
  Time exposure{}, delivered{};
  double computing_s = 0;
  bool failed = false;
};

// All calls belong to one thread, on which subscribers are called, too. The destructor stops the
// modules, also while pixels are still awaited; what was not delivered by then is forgotten.
class Pipeline {
 public:
  explicit Pipeline(const PipelineOptions& options);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // Before the first submit(). Errors: a name that is taken, a need that was not added before.
  Result<void> add(std::unique_ptr<Module> module);
  bool has(std::string_view module) const;

  // `use(frame, value, error)`: of each frame that was not dropped; one of value and error is null.
  // An error if there is no such module, or if submit() was called before. A module whose results
  // are another T gives errors to `use`.
  template <class T>
  Result<void> subscribe(const std::string& module,
                         std::function<void(const Frame&, const T*, const Error*)> use);
  // Calls `use` for each delivery.
  void log(std::function<void(const Delivery&)> use);

  // Never blocks, even if the pair's pixels are not available yet.
  void submit(StereoPair pair);
  // Delivers all results that are ready to their subscribers and returns their number. In lockstep waits
  // for results that are due and not computed yet.
  std::size_t poll(Time now);

  // For the end of a stream, and for files: waits until all frames are computed and delivers all results,
  // whenever they were due. Blocks forever if a pair's pixels never arrive.
  std::size_t finish();

  // In the order they were added.
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
    const Error other{Fault::usage, "results of module '" + module + "' are of another type"};
    use(frame, nullptr, &other);
  });
}

}  // namespace kaz::vision
