// Threads, mailboxes and delivery of a pipeline.
// SPDX-License-Identifier: Apache-2.0
#include "vision/pipeline/pipeline.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "shared/base/profile.hpp"

namespace kaz::vision {

namespace {

using Clock = std::chrono::steady_clock;
using FramePointer = std::shared_ptr<Frame>;

// The latest kMaxSamples durations, s.
class Times {
 public:
  void add(double s) {
    if (s_.size() < kMaxSamples) {
      s_.push_back(s);
    } else {
      s_[next_] = s;
    }
    next_ = (next_ + 1) % kMaxSamples;
  }
  void summary(double& median, double& p95, double& max) const {
    if (s_.empty()) return;
    std::vector<double> sorted = s_;
    std::sort(sorted.begin(), sorted.end());
    median = sorted[sorted.size() / 2];
    p95 = sorted[(sorted.size() * 95 + 99) / 100 - 1];
    max = sorted.back();
  }

 private:
  static constexpr std::size_t kMaxSamples = 1000;
  std::vector<double> s_;
  std::size_t next_ = 0;
};

Result<std::shared_ptr<const StereoImages>> wait_for_images(const StereoPair& pair,
                                                            const std::stop_token& stop) {
  if (!pair.images.valid())
    return fail(Fault::environment, "a stereo pair came without pixels: check the camera");
  while (pair.images.wait_for(std::chrono::milliseconds(5)) == std::future_status::timeout) {
    if (stop.stop_requested()) return fail(Fault::environment, "vision was stopped");
  }
  try {
    std::shared_ptr<const StereoImages> images = pair.images.get();
    if (images == nullptr)
      return fail(Fault::environment, "a stereo pair came with empty pixels: check the camera");
    return images;
  } catch (const std::exception& e) {
    return fail(Fault::environment, std::string("the camera failed on a stereo pair (") + e.what() +
                                        "): start it again");
  }
}

Result<std::any> look_guarded(Module& module, const Frame& frame) {
  try {
    return module.look(frame);
  } catch (const std::exception& e) {
    return fail(Fault::failed,
                "vision module " + module.name() + " failed on a picture: " + e.what());
  } catch (...) {
    return fail(Fault::failed,
                "vision module " + module.name() + " failed on a picture for an unknown reason");
  }
}

}  // namespace

struct Pipeline::State {
  using Slot = Frame::Slot;

  struct Worker {
    std::unique_ptr<Module> module;
    std::string name, part;  // part: its name in profiles
    Time latency{};
    std::vector<std::size_t> needs, feeds;
    std::vector<Use> subscribers;   // caller's thread
    std::deque<FramePointer> mail;  // under the mutex
    std::condition_variable_any
        called;  // there is mail; of its own, so that no other thread wakes up
    std::uint64_t delivered = 0, failed = 0;
    std::uint64_t dropped = 0;  // under the mutex
    Times computing, age;       // caller's thread
    std::jthread thread;
  };
  struct Due {
    Time due{};
    std::size_t module = 0;
    FramePointer frame;
  };

  PipelineOptions options;
  std::vector<std::unique_ptr<Worker>> workers;
  std::shared_ptr<Frame::Names> names = std::make_shared<Frame::Names>();
  std::function<void(const Delivery&)> log;
  bool started = false;
  std::optional<std::uint64_t> last_sequence;
  Time last_exposure{};
  std::vector<Due> pending;  // lockstep; caller's thread

  std::mutex mutex;
  std::condition_variable changed;  // a result is there
  std::vector<Due> done;            // real time; under the mutex
  std::size_t under_way = 0;        // results that are waited for; under the mutex
  Time latest_poll{};

  ~State() {
    for (auto& worker : workers) worker->thread.request_stop();
    for (auto& worker : workers) {
      if (worker->thread.joinable()) worker->thread.join();
    }
  }

  void start() {
    started = true;
    for (std::size_t i = 0; i < workers.size(); ++i)
      workers[i]->thread = std::jthread([this, i](const std::stop_token& stop) { work(i, stop); });
  }

  // The rest of the private part runs under the mutex, but for work().

  void post(std::size_t module, const FramePointer& frame) {
    Worker& worker = *workers[module];
    if (options.pace == Pace::realtime) {
      while (!worker.mail.empty()) {
        const FramePointer older = std::move(worker.mail.front());
        worker.mail.pop_front();
        ++worker.dropped;
        finish(module, older, Slot::State::dropped);
      }
    }
    worker.mail.push_back(frame);
    worker.called.notify_one();
  }

  // The module is through with the frame; those that need it may go on, or never will.
  void finish(std::size_t module, const FramePointer& frame, Slot::State state) {
    frame->slots_[module].state = state;
    --under_way;
    if (options.pace == Pace::realtime && state != Slot::State::dropped)
      done.push_back({Time{}, module, frame});
    for (const std::size_t next : workers[module]->feeds) {
      if (--frame->slots_[next].missing == 0) pass_on(next, frame);
    }
    changed.notify_all();
  }

  void pass_on(std::size_t module, const FramePointer& frame) {
    Slot& slot = frame->slots_[module];
    for (const std::size_t need : workers[module]->needs) {
      if (frame->slots_[need].state == Slot::State::dropped) {
        ++workers[module]->dropped;
        return finish(module, frame, Slot::State::dropped);
      }
    }
    for (const std::size_t need : workers[module]->needs) {
      if (frame->slots_[need].state != Slot::State::failed) continue;
      slot.error = frame->slots_[need].error;
      return finish(module, frame, Slot::State::failed);
    }
    post(module, frame);
  }

  void work(std::size_t module, const std::stop_token& stop) {
    Worker& worker = *workers[module];
    for (;;) {
      FramePointer frame;
      {
        std::unique_lock lock(mutex);
        if (!worker.called.wait(lock, stop, [&] { return !worker.mail.empty(); })) return;
        if (stop.stop_requested()) return;
        frame = std::move(worker.mail.front());
        worker.mail.pop_front();
      }
      const auto images = wait_for_images(frame->pair_, stop);
      if (images) {
        const std::lock_guard lock(mutex);
        // Once: others may be reading it.
        if (!frame->images_) frame->images_ = *images;
      }
      const ProfileScope part(worker.part.c_str());
      const auto begin = Clock::now();
      Result<std::any> seen = images ? look_guarded(*worker.module, *frame)
                                     : Result<std::any>(tl::unexpected(images.error()));
      const std::lock_guard lock(mutex);
      Slot& slot = frame->slots_[module];
      slot.computing_s = std::chrono::duration<double>(Clock::now() - begin).count();
      if (seen) {
        slot.value = std::move(*seen);
      } else {
        slot.error = std::move(seen.error());
      }
      finish(module, frame, seen ? Slot::State::done : Slot::State::failed);
    }
  }

  void deliver(const Due& item, Time now) {
    Worker& worker = *workers[item.module];
    const Slot& slot = item.frame->slots_[item.module];
    const bool failed = slot.state == Slot::State::failed;
    const Time delivered = options.pace == Pace::lockstep ? item.due : now;
    ++(failed ? worker.failed : worker.delivered);
    worker.computing.add(slot.computing_s);
    worker.age.add(seconds(between(delivered, item.frame->info().exposure)));
    if (log) {
      log({worker.name, item.frame->info().sequence, item.frame->info().exposure, delivered,
           slot.computing_s, failed});
    }
    for (const Use& use : worker.subscribers)
      use(*item.frame, failed ? nullptr : &slot.value, failed ? &*slot.error : nullptr);
  }

  std::vector<Due> take_due(Time now) {
    std::vector<Due> ready;
    std::copy_if(pending.begin(), pending.end(), std::back_inserter(ready),
                 [now](const Due& item) { return item.due <= now; });
    std::erase_if(pending, [now](const Due& item) { return item.due <= now; });
    std::stable_sort(ready.begin(), ready.end(),
                     [](const Due& a, const Due& b) { return a.due < b.due; });
    return ready;
  }
};

Pipeline::Pipeline(const PipelineOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
}
Pipeline::~Pipeline() = default;

bool Pipeline::has(std::string_view module) const {
  return state_->names->find(module) != state_->names->end();
}

Result<void> Pipeline::add(std::unique_ptr<Module> module) {
  auto worker = std::make_unique<State::Worker>();
  worker->name = module->name();
  worker->part = "vision " + worker->name;
  worker->latency = module->latency();
  const std::string about = "vision module '" + worker->name + "'";
  if (state_->started)
    return fail(Fault::usage, about + " was added too late: add modules before the first picture");
  if (has(worker->name)) return fail(Fault::usage, about + " exists already");
  const std::size_t index = state_->workers.size();
  for (const std::string& need : module->needs()) {
    const auto found = state_->names->find(need);
    if (found == state_->names->end())
      return fail(Fault::usage, about + " needs '" + need + "': add '" + need + "' first");
    worker->needs.push_back(found->second);
  }
  for (const std::size_t need : worker->needs) state_->workers[need]->feeds.push_back(index);
  (*state_->names)[worker->name] = index;
  worker->module = std::move(module);
  state_->workers.push_back(std::move(worker));
  return {};
}

Result<void> Pipeline::subscribe_any(const std::string& module, Use use) {
  const auto found = state_->names->find(module);
  if (found == state_->names->end())
    return fail(Fault::usage, "cannot subscribe: there is no vision module '" + module + "'");
  state_->workers[found->second]->subscribers.push_back(std::move(use));
  return {};
}

void Pipeline::log(std::function<void(const Delivery&)> use) {
  state_->log = std::move(use);
}

void Pipeline::submit(StereoPair pair) {
  State& s = *state_;
  if (!s.started) s.start();
  const auto frame = std::make_shared<Frame>();
  frame->pair_ = std::move(pair);
  frame->names_ = s.names;
  frame->slots_.resize(s.workers.size());
  const FrameInfo& info = frame->info();
  frame->after_gap_ =
      !s.last_sequence || info.sequence != *s.last_sequence + 1 || info.exposure <= s.last_exposure;
  s.last_sequence = info.sequence;
  s.last_exposure = info.exposure;
  std::vector<Time> due(s.workers.size());
  for (std::size_t i = 0; i < s.workers.size(); ++i) {
    const auto& needs = s.workers[i]->needs;
    Time ready = later(info.exposure, s.options.camera_latency);
    for (const std::size_t need : needs) ready = std::max(ready, due[need]);
    due[i] = later(ready, s.workers[i]->latency);
    frame->slots_[i].missing = static_cast<int>(needs.size());
    if (s.options.pace == Pace::lockstep) s.pending.push_back({due[i], i, frame});
  }
  const std::lock_guard lock(s.mutex);
  s.under_way += s.workers.size();
  for (std::size_t i = 0; i < s.workers.size(); ++i) {
    if (s.workers[i]->needs.empty()) s.post(i, frame);
  }
}

std::size_t Pipeline::poll(Time now) {
  State& s = *state_;
  s.latest_poll = now;
  std::vector<State::Due> ready;
  if (s.options.pace == Pace::lockstep) {
    ready = s.take_due(now);
  } else {
    const std::lock_guard lock(s.mutex);
    ready.swap(s.done);
  }
  for (const State::Due& item : ready) {
    {
      const ProfileScope waiting("waiting for vision");
      std::unique_lock lock(s.mutex);
      s.changed.wait(lock, [&] {
        return item.frame->slots_[item.module].state != Frame::Slot::State::waiting;
      });
    }
    s.deliver(item, now);
  }
  return ready.size();
}

std::size_t Pipeline::finish() {
  State& s = *state_;
  {
    std::unique_lock lock(s.mutex);
    s.changed.wait(lock, [&] { return s.under_way == 0; });
  }
  return poll(s.options.pace == Pace::lockstep ? Time::max() : s.latest_poll);
}

std::vector<ModuleStatistics> Pipeline::statistics() const {
  std::vector<ModuleStatistics> all;
  const std::lock_guard lock(state_->mutex);
  for (const auto& worker : state_->workers) {
    ModuleStatistics m;
    m.name = worker->name;
    m.delivered = worker->delivered;
    m.failed = worker->failed;
    m.dropped = worker->dropped;
    worker->computing.summary(m.computing_median_s, m.computing_p95_s, m.computing_max_s);
    worker->age.summary(m.age_median_s, m.age_p95_s, m.age_max_s);
    all.push_back(std::move(m));
  }
  return all;
}

}  // namespace kaz::vision
