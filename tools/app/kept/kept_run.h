// Restores the board after a run at a port, however the run ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/link/interrupt.h"
#include "host/link/link.h"
#include "host/robot/kept_board.h"
#include "tools/app/kept/kept_file.h"

namespace kaz::tools {

// Returns the folder of the notes: $XDG_STATE_HOME/kaz, else ~/.local/state/kaz. Empty without a home.
std::string kept_folder();

// Returns a sentence for each of the notes in `folder` that an earlier run on this port left: what to do with
// them. Includes damaged notes. Excludes notes of a run that still has the port.
std::vector<std::string> earlier_notes(const std::string& port,
                                       const std::string& folder = kept_folder());

// Inserts these sentences into the error if no board was found on the port. Without its notes `kaz recover`
// would restore only the board's address. Returns errors other than Fault::environment unchanged.
Error with_earlier_notes(Error error, const std::string& port,
                         const std::string& folder = kept_folder());

// Returns notes of this process on a port, without its board.
KeptFile this_run(const std::string& verb, const std::string& port);
// Writes `text` as KIND_PORT-PROCESS.json, or with a counter if that name is in use. Returns the path.
// Errors: environment.
Result<std::string> write_new_notes(const std::string& folder, const std::string& kind,
                                    const std::string& port, const std::string& text);

// Returns whether the run that wrote these notes is still running.
bool notes_in_use(const KeptFile& kept);
// Returns whether the notes belong to the board on this port. Its name must resolve as the noted one did, or
// both must name the same device. The device number alone is no criterion: it changes with each plugging, and
// a pty's with each run.
bool same_port(const KeptFile& kept, const std::string& port);

struct KeptRunOptions {
  std::string verb;  // "kaz conformance"
  std::string port;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  bool flash = false;  // the run may write the board's flash: address, calibration
  // Switches the motors off at the end. False: the run does this itself, once it has moved a joint.
  bool motors_off = true;
  // Lists the servos on a bus that are not off, with advice (PortLink::still_on). Null for boards.
  std::function<std::string()> still_on = nullptr;
  // Resets the board at the end, because the run may latch a shutdown, such as an emergency stop.
  bool reset = false;
  bool alone = false;  // the run disturbs every board on the line
  Time patience = host::PutBackOptions{}.patience;
  bool notes = true;                   // false: a reset undoes all changes of the run
  std::string folder = kept_folder();  // folder of the notes
};

class KeptRun {
 public:
  // Reads the state of the board and writes it down (kept_file.h), for `kaz recover --from` if this program
  // is killed. With `flash` the motors go off. Prints earlier_notes(). `link`, `clock` and `interrupt` must
  // outlive the object; `interrupt` is the one that link and clock use. Fails if no board replies, if other
  // boards are on the line although `alone`, or if notes cannot be written. Then the board is as before.
  static Result<std::unique_ptr<KeptRun>> begin(host::Link& link, host::Clock& clock,
                                                host::Interrupt& interrupt, KeptRunOptions options);
  // Calls end() if an exception skipped it, and prints its error.
  ~KeptRun();
  KeptRun(const KeptRun&) = delete;
  KeptRun& operator=(const KeptRun&) = delete;

  // Restores the board now, even after an interrupt. The run may continue afterwards.
  Result<void> put_back();
  // Calls put_back(), and removes the notes. The error contains what could not be restored, and the command
  // to do it; the notes then remain.
  Result<void> end();

  // From now on put_back() switches the motors off (KeptRunOptions::motors_off).
  void switch_motors_off();

  const host::BoardState& before() const { return kept_.board; }
  const std::string& notes_path() const { return path_; }

 private:
  KeptRun(host::Link& link, host::Clock& clock, host::Interrupt& interrupt, KeptRunOptions options);
  Result<void> write_notes();
  std::string command() const;  // command that restores the board
  void say_what_is_left() const;

  host::Link& link_;
  host::Clock& clock_;
  host::Interrupt& interrupt_;
  KeptRunOptions options_;
  KeptFile kept_;
  std::string path_;
  bool ended_ = false;
};

// Combines the result of a run with that of restoring its board. The first error counts; its message has
// both.
template <class T>
Result<T> together(Result<T> ran, const Result<void>& left) {
  if (left) return ran;
  if (ran) return tl::unexpected(left.error());
  return tl::unexpected(
      Error{ran.error().fault, ran.error().message + "; " + left.error().message});
}

}  // namespace kaz::tools
