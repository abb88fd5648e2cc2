// A run at a port that leaves the board as it found it, however the run ends.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kept/kept_run.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "host/link/port_address.h"
#include "host/robot/find_boards.h"
#include "shared/base/files.hpp"
#include "shared/base/number_text.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/kept/write_notes.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

// Links are followed, but the last: that is the name which stays where a device comes back, as in
// /dev/serial/by-id.
std::string line_of(const std::string& port) {
  if (host::names_port_kind(port)) return port;
  std::error_code error;
  fs::path at = fs::absolute(port, error).lexically_normal();
  for (int links = 0; links < 40 && fs::is_symlink(at, error); ++links) {
    fs::path to = fs::read_symlink(at, error);
    if (to.is_relative()) to = (at.parent_path() / to).lexically_normal();
    if (!fs::is_symlink(to, error)) break;
    at = to;
  }
  return (fs::weakly_canonical(at.parent_path(), error) / at.filename()).string();
}

constexpr const char* kBoard = "board";  // begins the names of such notes

// "/dev/ttyUSB0" or "can:can0" as a part of a file's name.
std::string file_name_of(const std::string& port) {
  std::string name = (host::names_port_kind(port) ? "_" : "") + line_of(port);
  for (char& c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (!plain) c = '_';
  }
  constexpr std::size_t kLongest = 100;
  if (name.size() > kLongest) name.erase(0, name.size() - kLongest);
  return name;
}

// When a process began (proc(5), field 22 of stat); 0: there is none, or it has ended (field 3).
std::uint64_t began(std::int64_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  // The second field is a name in brackets, and may hold anything.
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 2)));
  std::string field;
  for (int i = 3; i <= 22; ++i) {
    fields >> field;
    if (i == 3 && field == "Z") return 0;
  }
  return parse_number<std::uint64_t>(field).value_or(0);
}

// For notes that say nothing of it: whether a run of kaz with this process number, or NUMBER-COUNT, is there.
bool runs(const std::string& number) {
  std::string name;
  std::ifstream("/proc/" + number.substr(0, number.find('-')) + "/comm") >> name;
  return name == "kaz";
}

}  // namespace

std::string kept_folder() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value != nullptr ? value : "");
  };
  if (const std::string state = set("XDG_STATE_HOME"); state.starts_with('/'))
    return state + "/kaz";
  const std::string home = set("HOME");
  return home.empty() ? "" : home + "/.local/state/kaz";
}

bool notes_in_use(const KeptFile& kept) {
  return kept.process > 0 && began(kept.process) == kept.process_began;
}

bool same_port(const KeptFile& kept, const std::string& port) {
  const std::string then = kept.line.empty() ? line_of(kept.port) : kept.line;
  if (then == line_of(port)) return true;
  if (host::names_port_kind(then) || host::names_port_kind(port)) return false;
  // std::filesystem::equivalent() refuses devices.
  struct stat a {
  }, b{};
  if (::stat(then.c_str(), &a) != 0 || ::stat(port.c_str(), &b) != 0) return false;
  return S_ISCHR(a.st_mode) && S_ISCHR(b.st_mode) ? a.st_rdev == b.st_rdev
                                                  : a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

std::vector<std::string> earlier_notes(const std::string& port, const std::string& folder) {
  const std::string begin = kBoard + file_name_of(port) + "-", end = ".json";
  std::vector<std::string> paths, sentences;
  std::error_code none;
  for (fs::directory_iterator at(folder, none), last; !none && at != last; at.increment(none)) {
    const std::string name = at->path().filename();
    if (!name.starts_with(kBoard) || !name.ends_with(end)) continue;
    // Of damaged notes the name says what they are of.
    const std::size_t dash = name.find('-');
    const std::string number =
        dash == std::string::npos
            ? ""
            : name.substr(dash + 1, name.size() - std::min(name.size(), dash + 1 + end.size()));
    if (number.empty() || number.find_first_not_of("0123456789-") != std::string::npos) continue;
    const auto kept = read_kept(at->path());
    const bool of_port = kept ? same_port(*kept, port) : name.starts_with(begin);
    const bool used = kept && kept->process > 0 ? notes_in_use(*kept) : runs(number);
    if (of_port && !used) paths.push_back(at->path());
  }
  // The newest first: each describes the board as its run found it, altered by those before.
  std::ranges::sort(paths, [](const std::string& a, const std::string& b) {
    std::error_code gone;
    const auto of_a = fs::last_write_time(a, gone), of_b = fs::last_write_time(b, gone);
    return of_a != of_b ? of_a > of_b : a < b;
  });
  for (const std::string& path : paths) {
    const auto kept = read_kept(path);
    const std::string then = sentences.empty() ? "" : "after that: ";
    sentences.push_back(
        kept ? then + kept->verb + " on " + port +
                   " was ended before it could restore the board: `kaz recover " +
                   host::robot_option(port) + " --from " + path +
                   "` restores the board; to keep the board as it is, remove these notes"
             : then + "the notes of a run are not valid: " + kept.error().message +
                   "; this run did not restore the board on " + port + ": `kaz recover " +
                   host::robot_option(port) +
                   "` recovers the board without the notes; then remove the notes");
  }
  for (std::string& sentence : interrupted_writes(port, folder))
    sentences.push_back(std::move(sentence));
  return sentences;
}

Error with_earlier_notes(Error error, const std::string& port, const std::string& folder) {
  if (error.fault != Fault::environment) return error;
  // In front: it is the likeliest cause, and the command that ends it.
  std::string notes;
  for (const std::string& sentence : earlier_notes(port, folder)) notes += sentence + "; ";
  error.message.insert(0, notes);
  return error;
}

KeptFile this_run(const std::string& verb, const std::string& port) {
  KeptFile run;
  run.verb = verb;
  std::error_code no_folder;
  run.port = host::names_port_kind(port)
                 ? port
                 : fs::absolute(port, no_folder).lexically_normal().string();
  run.line = line_of(port);
  run.process = getpid();
  run.process_began = began(getpid());
  return run;
}

Result<std::string> write_new_notes(const std::string& folder, const std::string& kind,
                                    const std::string& port, const std::string& text) {
  if (folder.empty()) return fail(Fault::environment, "neither XDG_STATE_HOME nor HOME is set");
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    return fail(Fault::environment,
                folder + ": cannot create the folder (" + error.message() + ")");
  // Process numbers repeat: notes that a killed run has left stay.
  const std::string begin =
      folder + "/" + kind + file_name_of(port) + "-" + std::to_string(getpid());
  std::string path = begin + ".json";
  for (int n = 2; fs::exists(fs::symlink_status(path, error)); ++n)
    path = begin + "-" + std::to_string(n) + ".json";
  KAZ_TRY(write_whole_file(path, text));
  return path;
}

KeptRun::KeptRun(host::Link& link, host::Clock& clock, host::Interrupt& interrupt,
                 KeptRunOptions options)
    : link_(link), clock_(clock), interrupt_(interrupt), options_(std::move(options)) {}

Result<std::unique_ptr<KeptRun>> KeptRun::begin(host::Link& link, host::Clock& clock,
                                                host::Interrupt& interrupt,
                                                KeptRunOptions options) {
  std::unique_ptr<KeptRun> run(new KeptRun(link, clock, interrupt, std::move(options)));
  const KeptRunOptions& o = run->options_;
  run->ended_ = true;  // until it is known what to put back
  run->kept_ = this_run(o.verb, o.port);
  const auto board = host::read_board(link, clock, o.address);
  // Also what fails because of a signal is its end.
  const auto ended = [&](Error error) {
    if (interrupt.requested() && error.fault == Fault::environment)
      error = {Fault::interrupted, "interrupted; " + error.message};
    return tl::unexpected(std::move(error));
  };
  if (!board) return ended(with_earlier_notes(board.error(), o.port, o.folder));
  run->kept_.board = *board;
  if (o.flash || o.alone) {
    auto others = KAZ_TRY(host::find_boards(link, clock));
    std::erase(others, o.address);
    if (o.alone && !others.empty())
      return fail(Fault::usage, "other boards are on " + o.port + ", at " +
                                    host::addresses_text(others) +
                                    ", and this run disturbs every board on its line: connect only "
                                    "the board at address " +
                                    std::to_string(o.address));
    run->kept_.others = std::move(others);
  }
  for (const std::string& sentence : earlier_notes(o.port, o.folder))
    std::fprintf(stderr, "%s: %s\n", o.verb.c_str(), sentence.c_str());
  if (o.notes) KAZ_TRY(run->write_notes());
  run->ended_ = false;
  run->say_what_is_left();
  if (!o.flash) return run;
  // From here on the board is altered: by a reset.
  auto kept = host::read_flash(link, clock, run->kept_.board);
  if (kept && o.notes) kept = run->write_notes();
  if (!kept) return ended(together(std::move(kept), run->end()).error());
  return run;
}

Result<void> KeptRun::write_notes() {
  const auto cannot = [](const std::string& why) {
    return fail(Fault::environment,
                "the board's settings cannot be saved, so the run does not start: " + why +
                    "; set XDG_STATE_HOME to a writable folder");
  };
  if (!path_.empty()) {
    if (const auto written = write_whole_file(path_, kept_text(kept_)); !written)
      return cannot(written.error().message);
    return {};
  }
  const auto written = write_new_notes(options_.folder, kBoard, options_.port, kept_text(kept_));
  if (!written) return cannot(written.error().message);
  path_ = *written;
  return {};
}

std::string KeptRun::command() const {
  return path_.empty() ? "kaz recover " + host::robot_option(options_.port) + " --address " +
                             std::to_string(options_.address)
                       : "kaz recover " + host::robot_option(options_.port) + " --from " + path_;
}

void KeptRun::say_what_is_left() const {
  const auto& o = options_;
  leaves_behind(o.still_on ? "the servos on " + o.port + " may still have torque: cut their power"
                           : "the board on " + o.port +
                                 " may still differ from its state before this run" +
                                 (o.motors_off ? ", and its motors may be on" : "") + ": give `" +
                                 command() + "`");
}

void KeptRun::switch_motors_off() {
  options_.motors_off = true;
  if (!ended_) say_what_is_left();
}

Result<void> KeptRun::put_back() {
  if (interrupt_.requested() && options_.flash)
    std::fprintf(
        stderr,
        "%s: interrupted; restoring the contents of the board's flash, which takes some seconds\n",
        options_.verb.c_str());
  // put_back() ends by its patience; this only if it does not.
  const host::CleanUp clean_up(
      interrupt_, std::chrono::duration_cast<std::chrono::milliseconds>(3 * options_.patience));
  const auto back = host::put_back(link_, clock_, kept_.board,
                                   {.patience = options_.patience,
                                    .flash = options_.flash,
                                    .reset = options_.reset,
                                    .motors_off = options_.motors_off,
                                    .others = kept_.others});
  for (const std::string& note : back.notes)
    std::fprintf(stderr, "%s: %s\n", options_.verb.c_str(), note.c_str());
  if (back.left.empty()) {
    const char* const off = options_.motors_off ? "motors off (the robot sinks down)" : "";
    const bool servo_bus =
        options_.still_on != nullptr;  // a servo has no settings that a run changes
    if (servo_bus && options_.motors_off)
      std::fprintf(stderr, "%s: %s: %s\n", options_.verb.c_str(), options_.port.c_str(), off);
    else if (!servo_bus && !back.done.empty())
      std::fprintf(stderr, "%s: %s: %s%srestored: %s\n", options_.verb.c_str(),
                   options_.port.c_str(), off, *off ? "; " : "", joined(back.done).c_str());
    return {};
  }
  const std::string on = options_.still_on ? options_.still_on() : "";
  if (!on.empty()) return fail(Fault::environment, options_.port + ": " + on);
  return fail(
      Fault::environment,
      "the board on " + options_.port +
          " may still differ from its state before this run; not restored: " + joined(back.left) +
          (options_.motors_off ? ": its motors may be on, so support the robot, then give `" +
                                     command() + "`, which switches the motors off"
                               : ": give `" + command() + "`"));
}

Result<void> KeptRun::end() {
  if (ended_) return {};
  ended_ = true;
  const auto back = put_back();
  leaves_behind("");
  if (!back) return back;
  std::error_code error;
  if (!path_.empty() && !fs::remove(path_, error) && error)
    std::fprintf(stderr,
                 "%s: the board is restored, but the file with its settings was not deleted (%s); "
                 "delete %s\n",
                 options_.verb.c_str(), error.message().c_str(), path_.c_str());
  return {};
}

KeptRun::~KeptRun() {
  try {
    if (const auto ended = end(); !ended)
      std::fprintf(stderr, "%s: %s\n", options_.verb.c_str(), ended.error().message.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: the board was not restored: %s\n", options_.verb.c_str(),
                 error.what());
  }
}

}  // namespace kaz::tools
