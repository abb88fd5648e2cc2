// A run at a port that leaves the board as it found it, however the run ends.
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

// Of the notes: $XDG_STATE_HOME/kaz, else ~/.local/state/kaz; empty without a home.
std::string kept_folder();

// One sentence for each of the notes in `folder` that an earlier run on the port has left: what to do with
// them, also where they are damaged. None is there while that run goes on, since it has the port.
std::vector<std::string> earlier_notes(const std::string& port,
                                       const std::string& folder = kept_folder());

// The error of a board that was not found on the port, with those notes: without them `kaz recover` would put
// back its address alone. Other errors (usage, failed, interrupted) as they are.
Error with_earlier_notes(Error error, const std::string& port,
                         const std::string& folder = kept_folder());

// The run of this process on a port, without its board.
KeptFile this_run(const std::string& verb, const std::string& port);
// Writes `text` as KIND_PORT-PROCESS.json, a name that no other notes have. Errors (environment). Returns the
// path.
Result<std::string> write_new_notes(const std::string& folder, const std::string& kind,
                                    const std::string& port, const std::string& text);

// Whether the run that wrote these notes, wherever they lie now, is still under way.
bool notes_in_use(const KeptFile& kept);
// Whether the notes are of the board on this port: its name leads where theirs did then, or both are names of
// one device. The device's own number is none: it changes with each plugging, and a pty's with each run.
bool same_port(const KeptFile& kept, const std::string& port);

struct KeptRunOptions {
  std::string verb;  // "kaz conformance"
  std::string port;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  bool flash = false;  // the run may write the board's flash: its address, its calibration
  bool motors_off =
      true;  // at the end; false: the run does that itself, once it has moved anything
  // Of a bus of servos, those that are not off, with what to do (PortLink::still_on).
  std::function<std::string()> still_on = nullptr;
  bool reset = false;  // at the end: the run may latch a shutdown, such as an emergency stop
  bool alone = false;  // the run disturbs every board on the line
  Time patience = host::PutBackOptions{}.patience;
  bool notes = true;                   // false: the run alters only what a reset undoes
  std::string folder = kept_folder();  // of the notes
};

class KeptRun {
 public:
  // Reads the board and writes down what it is like (kept_file.h), for `kaz recover --from` in case this
  // program is killed. Motors go off if `flash`. Prints earlier_notes(). `link`, `clock` and `interrupt`,
  // which is that of both, must outlive it. Errors: nothing answers; other boards on the line although
  // `alone`; notes cannot be written. The board is as it was then.
  static Result<std::unique_ptr<KeptRun>> begin(host::Link& link, host::Clock& clock,
                                                host::Interrupt& interrupt, KeptRunOptions options);
  // end(), where an exception has skipped it; the error is printed.
  ~KeptRun();
  KeptRun(const KeptRun&) = delete;
  KeptRun& operator=(const KeptRun&) = delete;

  // Puts the board back now, interrupted or not; the run may go on afterwards.
  Result<void> put_back();
  // put_back(), and removes the notes. The error names what could not be put back, and the command that does
  // it; the notes then remain.
  Result<void> end();

  // From now on motors are switched off at the end (KeptRunOptions::motors_off).
  void switch_motors_off();

  const host::BoardState& before() const { return kept_.board; }
  const std::string& notes_path() const { return path_; }

 private:
  KeptRun(host::Link& link, host::Clock& clock, host::Interrupt& interrupt, KeptRunOptions options);
  Result<void> write_notes();
  std::string command() const;  // that puts the board back
  void say_what_is_left() const;

  host::Link& link_;
  host::Clock& clock_;
  host::Interrupt& interrupt_;
  KeptRunOptions options_;
  KeptFile kept_;
  std::string path_;
  bool ended_ = false;
};

// How a run ended together with how its board was left: the first error counts, its sentence has both.
template <class T>
Result<T> together(Result<T> ran, const Result<void>& left) {
  if (left) return ran;
  if (ran) return tl::unexpected(left.error());
  return tl::unexpected(
      Error{ran.error().fault, ran.error().message + "; " + left.error().message});
}

}  // namespace kaz::tools
