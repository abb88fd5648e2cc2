// Steps, tries, and a clock that rings.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/composition.h"

#include <algorithm>
#include <cstdio>

namespace kaz::behavior {

namespace {

// That of another, up to a time: then every wait ends with an error.
class Deadline final : public host::Clock {
 public:
  Deadline(host::Clock& clock, Time end) : clock_(clock), end_(end) {}
  Time now() const override { return clock_.now(); }
  Result<void> sleep_until(Time t) override {
    if (auto slept = clock_.sleep_until(std::min(t, end_)); !slept) return slept;
    if (t <= end_) return {};
    over_ = true;
    return fail(Fault::environment, "the time limit is reached: raise the limit");
  }
  bool over() const { return over_; }

 private:
  host::Clock& clock_;
  Time end_;
  bool over_ = false;
};

// The same context with another clock. Binds every member: after one more is added to Context, this does
// not compile until it is passed on, too.
Context with_clock(const Context& context, host::Clock& clock) {
  const auto& [robot, own_clock, vision, sink, options, seed, joints, radius_m, camera, patience,
               requests] = context;
  return {robot, clock, vision, sink, options, seed, joints, radius_m, camera, patience, requests};
}

}  // namespace

Task sequence(std::string behavior, std::vector<Step> steps) {
  return [behavior = std::move(behavior),
          steps = std::move(steps)](Context& context) -> Result<Outcome> {
    Outcome all;
    all.success = true;
    for (const Step& step : steps) {
      context.sink.phase(context.clock.now(), behavior, step.name);
      auto outcome = step.run(context);
      if (!outcome) return outcome;
      outcome->measurements.insert(outcome->measurements.begin(), all.measurements.begin(),
                                   all.measurements.end());
      all = std::move(*outcome);
      if (!all.success) break;
    }
    return all;
  };
}

Task fallback(std::string behavior, std::vector<Step> steps) {
  return [behavior = std::move(behavior),
          steps = std::move(steps)](Context& context) -> Result<Outcome> {
    Result<Outcome> last = Outcome{false, "the list of steps is empty", {}, "no steps"};
    for (const Step& step : steps) {
      context.sink.phase(context.clock.now(), behavior, step.name);
      last = step.run(context);
      if (!last || last->success) break;
    }
    return last;
  };
}

Task retry(int times, Task task, std::function<bool(const Outcome&)> retriable) {
  return [times, task = std::move(task),
          retriable = std::move(retriable)](Context& context) -> Result<Outcome> {
    for (int tries = 1;; ++tries) {
      auto outcome = task(context);
      if (!outcome) return outcome;
      if (outcome->success || tries >= times || (retriable && !retriable(*outcome))) {
        outcome->measurements.emplace_back("tries", tries);
        return outcome;
      }
    }
  };
}

Task within(Time limit, Task task) {
  return [limit, task = std::move(task)](Context& context) -> Result<Outcome> {
    Deadline clock(context.clock, context.clock.now() + limit);
    Context limited = with_clock(context, clock);
    auto outcome = task(limited);
    if (outcome || !clock.over()) return outcome;
    char text[80];
    std::snprintf(text, sizeof text, "the task did not finish within %g s", seconds(limit));
    return Outcome{false, text, {}, "time"};
  };
}

}  // namespace kaz::behavior
