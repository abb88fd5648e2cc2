// Where vision runs: beside the control loop, with results delivered at a defined time.
// SPDX-License-Identifier: Apache-2.0
//
// Design section 3. In lockstep a result arrives exactly a declared latency after its picture,
// however long the computation took; against the wall clock it arrives when it is done, and old
// pictures are skipped.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "vision/frame.h"

namespace kaz::vision {

// One module's work on one frame.
struct Work {
  const void* module =
      nullptr;  // whose work: of one module, the newest waiting frame wins in real time
  Time due{};   // when the result exists in simulated time
  // On a worker thread. Must return soon once the token is stopped, and must not throw:
  // run_guarded() of this header turns exceptions into an Error.
  std::function<void(std::stop_token)> run;
  std::function<void()> deliver;  // on the thread that calls poll(), after run() returned
};

struct ExecutorStatistics {
  std::uint64_t submitted = 0, delivered = 0;
  std::uint64_t dropped = 0;  // replaced by a newer frame before work on them began
};

// submit(), poll() and statistics() belong to one thread. The destructor stops and joins the
// workers; work not delivered by then is forgotten.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void submit(Work work) = 0;  // never waits
  // Delivers what has become ready and returns how much that was.
  virtual std::size_t poll(Time now) = 0;
  virtual ExecutorStatistics statistics() const = 0;
};

// Deterministic: work starts at once on a worker, in order of submission; poll() delivers it when
// now >= due, in order of due time, and waits for the worker where it is not finished.
std::unique_ptr<Executor> make_lockstep_executor();

// Real time: one worker; per module the newest waiting frame replaces an older one; poll() delivers
// whatever is done, whenever it was due.
std::unique_ptr<Executor> make_realtime_executor();

// Waits for the pixels of a pair, giving up when stopped; an error where the camera dropped them.
Result<std::shared_ptr<const StereoImages>> wait_for_images(const StereoPair& pair,
                                                            std::stop_token stop);

// Runs f and turns what it throws into an Error that names the module.
Result<void> run_guarded(const char* module, const std::function<void()>& f);

}  // namespace kaz::vision
