// A run at a port that leaves the board as it found it, however the run ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "host/link/link.h"
#include "host/robot/kept_board.h"
#include "tools/app/kept/kept_file.h"

namespace kaz::tools {

// Of the notes: $XDG_STATE_HOME/kaz, else ~/.local/state/kaz; empty without a home.
std::string kept_folder();

struct KeptRunOptions {
  std::string verb;  // "kaz conformance"
  std::string port;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  bool flash = false;  // the run may write the board's flash: its address, its calibration
  bool motors_off =
      true;            // at the end; false: the run does that itself, once it has moved anything
  bool alone = false;  // the run disturbs every board on the line
  Time patience = host::PutBackOptions{}.patience;
  std::string folder = kept_folder();  // of the notes; empty: none are written
};

class KeptRun {
 public:
  // Reads the board and writes down what it is like (kept_file.h), for `kaz recover --from` in case this
  // program is killed. Motors go off if `flash`. `link` and `clock` must outlive it; no interrupt may end the
  // clock. Errors: nothing answers; other boards on the line although `alone`.
  static Result<std::unique_ptr<KeptRun>> begin(host::Link& link, host::Clock& clock,
                                                KeptRunOptions options);
  // end(), where an exception has skipped it; the error is printed.
  ~KeptRun();
  KeptRun(const KeptRun&) = delete;
  KeptRun& operator=(const KeptRun&) = delete;

  // Puts the board back now; the run may go on afterwards.
  Result<void> put_back();
  // Puts the board back, interrupted or not, and removes the notes. The error names what could not be put
  // back, and the command that does it; the notes then remain.
  Result<void> end();

  const host::BoardState& before() const { return kept_.board; }
  // Empty if they could not be written.
  const std::string& notes_path() const { return path_; }

 private:
  KeptRun(host::Link& link, host::Clock& clock, KeptRunOptions options);
  void write_notes();

  host::Link& link_;
  host::Clock& clock_;
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
