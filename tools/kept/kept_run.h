// Restores the state of the board after a run at a port, also after an error or an interrupt.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/link/interrupt.h"
#include "host/link/link.h"
#include "host/robot/kept_board.h"
#include "tools/kept/kept_file.h"

namespace kaz::tools {

// Returns the folder of the notes: $XDG_STATE_HOME/kaz, else ~/.local/state/kaz. Empty if the user has no
// home folder.
std::string kept_folder();

// Returns one sentence per file of notes in `folder` that an earlier run on this port has left. The sentence
// tells the user how to use the notes. Includes damaged notes. Excludes notes of a run that is still using
// the port.
std::vector<std::string> earlier_notes(const std::string& port,
                                       const std::string& folder = kept_folder());

// If `error` reports that no board was found on the port, adds the sentences of earlier_notes(). Without the
// notes, `kaz recover` would restore only the board's address. Returns errors other than Fault::environment
// unchanged.
Error with_earlier_notes(Error error, const std::string& port,
                         const std::string& folder = kept_folder());

// Returns notes of this process for a run on the port. KeptFile::board is not set.
KeptFile this_run(const std::string& verb, const std::string& port);
// Writes `text` to a new file KIND_PORT-PROCESS.json. If this name is in use, appends a counter to the name.
// Returns the path of the file. Fails with Fault::environment.
Result<std::string> write_new_notes(const std::string& folder, const std::string& kind,
                                    const std::string& port, const std::string& text);

// Returns whether the run that wrote these notes is still running.
bool notes_in_use(const KeptFile& kept);
// Returns whether the notes belong to the board on this port. The name `port` must resolve to the same path
// as in the notes, or both names must refer to the same device. The device number is not compared, because it
// changes each time a device is plugged in. The number of a pty changes with each run.
bool same_port(const KeptFile& kept, const std::string& port);

struct KeptRunOptions {
  std::string verb;  // for example "kaz conformance"
  std::string port;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  bool flash = false;  // the run may write the address or the calibration in the board's flash
  // True: the motors are switched off at the end. False: the motors are switched off only if
  // switch_motors_off() was called.
  bool motors_off = true;
  // Returns a text with advice that lists the servos whose torque is still on (PortLink::still_on). Null for
  // boards.
  std::function<std::string()> still_on = nullptr;
  // True: the board is reset at the end, because the run may cause the board to latch a shutdown, such as an
  // emergency stop.
  bool reset = false;
  bool alone = false;  // the run disturbs every board on the line
  Time patience = host::PutBackOptions{}.patience;
  // False: no notes are written, because a reset undoes all changes of the run.
  bool notes = true;
  std::string folder = kept_folder();  // folder of the notes
};

class KeptRun {
 public:
  // Reads the state of the board and writes the state to notes (kept_file.h). If this program is killed, `kaz
  // recover --from` reads these notes. With `flash`, switches the motors off. Prints earlier_notes(). `link`,
  // `clock` and `interrupt` must outlive the object; `link` and `clock` must use the same `interrupt`. Fails
  // if no board replies, if KeptRunOptions::alone is set and other boards are on the line, or if the notes
  // cannot be written. After a failure, the state of the board is unchanged.
  static Result<std::unique_ptr<KeptRun>> begin(host::Link& link, host::Clock& clock,
                                                host::Interrupt& interrupt, KeptRunOptions options);
  // If an exception has prevented the call of end(), the destructor calls end() and prints the error of
  // end().
  ~KeptRun();
  KeptRun(const KeptRun&) = delete;
  KeptRun& operator=(const KeptRun&) = delete;

  // Restores the state of the board now, even after an interrupt. The run may continue afterwards.
  Result<void> put_back();
  // Calls put_back(), and removes the notes. If a setting could not be restored, the error lists the setting
  // and the command that restores it, and the notes remain.
  Result<void> end();

  // After this call, put_back() switches the motors off, as with KeptRunOptions::motors_off.
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

// Combines the result `ran` of a run with the result `left` of restoring the board. If both are errors,
// returns an error with the fault of `ran` and the messages of both.
template <class T>
Result<T> together(Result<T> ran, const Result<void>& left) {
  if (left) return ran;
  if (ran) return tl::unexpected(left.error());
  ran.error().message += "; " + left.error().message;
  return ran;
}

}  // namespace kaz::tools
