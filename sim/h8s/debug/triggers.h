// Sets breakpoints and watchpoints on a chip for the duration of one run. Internal to debug/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/h8s/chip/observer.h"
#include "sim/h8s/debug/history.h"

namespace kaz::h8s {

// Returns the first watchpoint that `access` hits; null if `access` hits no watchpoint.
const Watch* find_watch(const std::vector<Watch>& watches, const Access& access);

// Halts the chip at the first trigger. `chip` and `triggers` must outlive this object. The destructor removes
// all code hooks at the breakpoints.
class ArmedTriggers final : public Observer {
 public:
  ArmedTriggers(Chip& chip, const Triggers& triggers);
  ~ArmedTriggers() override;
  ArmedTriggers(const ArmedTriggers&) = delete;
  ArmedTriggers& operator=(const ArmedTriggers&) = delete;

  void accessed(const Access& access) override;
  // Returns a Halt that contains the reason for the end of the run. `stop` is the Stop that the run returned.
  Halt halt(const Stop& stop) const;

 private:
  Chip& chip_;
  const Triggers& triggers_;
  std::optional<Halt> watched_;
};

// Records the last boundary before `limit` at which a trigger fires, without halting. `chip` and `triggers`
// must outlive this object.
class NotedTriggers final : public Observer {
 public:
  NotedTriggers(Chip& chip, const Triggers& triggers, States limit);
  ~NotedTriggers() override;
  NotedTriggers(const NotedTriggers&) = delete;
  NotedTriggers& operator=(const NotedTriggers&) = delete;

  void accessed(const Access& access) override;
  void executed(const Executed& e) override { settle(e.begin); }
  void entered(const ExceptionEntry& e) override { settle(e.begin); }

  struct Hit {
    States at = 0;
    Halt halt;
  };
  const std::optional<Hit>& last() const { return last_; }

 private:
  void settle(States begin);

  Chip& chip_;
  const Triggers& triggers_;
  States limit_;
  std::optional<Halt> pending_;
  std::optional<Hit> last_;
};

}  // namespace kaz::h8s
