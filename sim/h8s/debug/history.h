// Reverse execution: snapshots, and replay of the inputs since.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/h8s/chip/chip.h"
#include "sim/h8s/chip/observer.h"

namespace kaz::h8s {

// Accesses to [address, address + size).
struct Watch {
  std::uint32_t address = 0;
  std::uint32_t size = 1;
  bool read = false;
  bool write = true;
  bool operator==(const Watch&) const = default;
};

// Conditions that halt a run. A breakpoint replaces a code hook at its address for the duration of the
// run. A breakpoint at the run's first instruction counts only with `at_start`.
struct Triggers {
  std::vector<std::uint32_t> breakpoints;
  std::vector<Watch> watches;
  bool at_start = false;
};

struct Halt {
  enum class Why {
    reached,
    breakpoint,  // the instruction there has not run
    watch,       // forwards: after the access; backwards: before the instruction that does it
    begin,       // backwards: the start of the history
    stopped,     // the chip stopped by itself, for the reason in `stop`
  };
  Why why = Why::reached;
  Stop stop;
  std::uint32_t address = 0;  // watch: address of the access
  Watch watch;                // watch: the one that was hit
};

struct HistoryOptions {
  States spacing = 100'000;    // states between the newest snapshots
  std::size_t snapshots = 40;  // maximum number; older ones are further apart; 0.2 MB each
  // Inputs and A/D samples, about 40 bytes each. With more, the oldest part of the history is forgotten.
  std::size_t records = 2'000'000;
};

// Records a chip from its construction on. The chip must be run through this object, which takes
// snapshots meanwhile; execution before end() is replayed from the record, without calling the chip's
// listeners a second time. An input in the past (a poke, a pin) discards the record after it. Load,
// power_on, restore and inputs from inside listeners restart the history; inputs from code hooks are
// recorded.
class History final : public InputLog {
 public:
  explicit History(Chip& chip, HistoryOptions options = {});
  ~History() override;
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  // First and last state that can be visited. The first moves on in a session with many records.
  States begin() const;
  States end() const;
  // Whether the chip is before end(), so that running replays the record.
  bool replaying() const;

  Halt run_until(States until, const Triggers& triggers = {});
  // As Chip::step.
  Halt step();

  // To the boundary before this one. Halt::begin if there is none.
  Halt step_back();
  // To the first boundary at or after `at`. Errors: outside begin()..end().
  Result<void> back_to(States at);
  // To the last boundary before this one where a trigger fires, else to begin().
  Halt reverse_continue(const Triggers& triggers);

  void input(std::function<void(Chip&)> apply) override;
  void cut() override;
  void sampled(int channel, States at, double value) override;

 private:
  struct Input {
    States at;
    std::function<void(Chip&)> apply;
  };
  struct Sample {
    States at;
    int channel;
    double value;
  };
  struct Snapshot {
    States at;
    std::size_t inputs;  // applied before it was taken
    std::shared_ptr<const Chip> chip;
  };
  struct Player;

  Player player(const Snapshot& from) const;
  Player player(const Chip& from, std::size_t inputs) const;
  Halt run_live(States until, const Triggers& triggers);
  void adopt(const Player& player);
  void restart();
  void mend();
  void snapshot();
  void thin_snapshots();
  void forget_past();
  void forget_future();
  const Snapshot* last_before(States at) const;

  Chip& chip_;
  HistoryOptions options_;
  std::vector<Snapshot> snapshots_;
  std::vector<Input> inputs_;
  std::vector<Sample> samples_;
  std::size_t cursor_ = 0;  // inputs applied to the chip so far
  States end_ = 0;
  bool adopting_ = false;
  bool broken_ = false;  // cut while the chip ran: restart at the next boundary
};

}  // namespace kaz::h8s
