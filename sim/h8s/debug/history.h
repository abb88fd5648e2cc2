// Reverse execution: restores a snapshot and replays the inputs after this snapshot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/h8s/chip/chip.h"
#include "sim/h8s/chip/observer.h"

namespace kaz::h8s {

// Watchpoint: accesses to [address, address + size).
struct Watch {
  std::uint32_t address = 0;
  std::uint32_t size = 1;
  bool read = false;
  bool write = true;
  bool operator==(const Watch&) const = default;
};

// Conditions that halt a run. A breakpoint replaces a code hook at the same address. The end of the run
// removes the breakpoint, so the address has no hook after the run. A replay leaves the code hooks unchanged.
// A breakpoint at the first instruction of a run halts the run only if `at_start` is true.
struct Triggers {
  std::vector<std::uint32_t> breakpoints;
  std::vector<Watch> watches;
  bool at_start = false;
};

// Reason for the end of a run or of a step.
struct Halt {
  enum class Why {
    reached,     // the requested time was reached, or the step is complete
    breakpoint,  // a breakpoint was reached; the instruction there has not run
    // A watchpoint was hit. A forward run halts after the access. A backward run halts before the instruction
    // that makes the access.
    watch,
    begin,    // the start of the history was reached in a backward run
    stopped,  // the chip stopped for the reason in `stop`
  };
  Why why = Why::reached;
  Stop stop;
  std::uint32_t address = 0;  // Why::watch: address of the access
  Watch watch;                // Why::watch: the watchpoint
};

struct HistoryOptions {
  // Time, in states, from one snapshot until the next snapshot is taken.
  States spacing = 100'000;
  // Maximum number of snapshots, 0.2 MB each. If a new snapshot exceeds this maximum, the history drops an
  // earlier snapshot. As a result, old snapshots are farther apart than new snapshots.
  std::size_t snapshots = 40;
  // Maximum number of inputs and A/D samples, about 40 bytes each. If the number exceeds the maximum, the
  // oldest part of the history is dropped.
  std::size_t records = 2'000'000;
};

// Records a chip, starting when this object is constructed. The chip must outlive this object. Run the chip
// only through this object, which takes snapshots during the run. A run that begins before end() replays the
// record up to end(). The replay does not call the chip's listeners again. If an input (such as a poke or a
// pin level) occurs at a time before end(), the rest of the record is discarded. The history is discarded and
// started again after a call of Chip::load, power_on, restore, read_state or call, and after an input from a
// listener. Inputs from code hooks are recorded.
class History final : public InputLog {
 public:
  explicit History(Chip& chip, HistoryOptions options = {});
  ~History() override;
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  // Return the first and the last time to which the chip can be moved. begin() increases when old records are
  // dropped.
  States begin() const;
  States end() const;
  // Returns whether the time of the chip is before end(). If true, the next run replays the record.
  bool replaying() const;

  // Runs to the time `until`, or to the first trigger before it.
  Halt run_until(States until, const Triggers& triggers = {});
  // Runs one step, like Chip::step.
  Halt step();

  // Goes back to the previous instruction boundary. Returns Why::begin at the start of the history.
  Halt step_back();
  // Goes to the first boundary at or after `at`. Error: `at` is not in begin()..end().
  Result<void> back_to(States at);
  // Runs backward from the current instruction boundary until a trigger fires. Triggers at the current
  // boundary are ignored. If no trigger fires, goes back to begin().
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
    std::size_t inputs;  // number of recorded inputs before the snapshot
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
  std::size_t cursor_ = 0;  // number of inputs already applied to chip_
  States end_ = 0;
  bool adopting_ = false;
  bool broken_ = false;  // an input could not be recorded; the next call restarts the history
};

}  // namespace kaz::h8s
