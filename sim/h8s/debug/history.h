// Going back in time: snapshots, and what came from outside since, played again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "shared/image/error.h"
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

// Where a run is to halt. A breakpoint takes the place of a code hook at its address for the time
// of the run. One at the instruction where the run begins counts only with `at_start`.
struct Triggers {
  std::vector<std::uint32_t> breakpoints;
  std::vector<Watch> watches;
  bool at_start = false;
};

struct Halt {
  enum class Why {
    reached,
    breakpoint,  // the instruction there has not run
    watch,       // forwards: after the access; backwards: before the instruction that makes it
    begin,       // backwards: history begins here
    stopped,     // the chip stopped by itself: `stop` tells why
  };
  Why why = Why::reached;
  Stop stop;
  std::uint32_t address = 0;  // watch: what was accessed
  Watch watch;                // watch: the one that was hit
};

struct HistoryOptions {
  States spacing = 100'000;    // between the newest snapshots
  std::size_t snapshots = 40;  // kept at most; older ones stand further apart; 0.2 MB each
};

// Records a chip from its construction on. Run the chip through this object: then snapshots are
// taken on the way, and what lies before end() is played again as it was, without calling the
// chip's listeners a second time. An input given in the past (a poke, a pin) makes a new future:
// what followed is dropped. Load, power_on and restore begin the history anew, and so do inputs
// from inside listeners; inputs from code hooks are recorded.
class History final : public InputLog {
 public:
  explicit History(Chip& chip, HistoryOptions options = {});
  ~History() override;
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  // First and last state that can be visited.
  States begin() const;
  States end() const;
  // The chip stands before end(): running on plays the record.
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
  void forget_future();
  const Snapshot* last_before(States at) const;

  Chip& chip_;
  HistoryOptions options_;
  std::vector<Snapshot> snapshots_;
  std::vector<Input> inputs_;
  std::vector<Sample> samples_;
  std::size_t cursor_ = 0;  // inputs applied to the chip where it stands
  States end_ = 0;
  bool adopting_ = false;
  bool broken_ = false;  // cut while the chip ran: begin anew at the next boundary
};

}  // namespace kaz::h8s
