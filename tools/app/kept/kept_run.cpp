// A run at a port that leaves the board as it found it, however the run ends.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/kept/kept_run.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>

#include "host/robot/find_boards.h"
#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

// "/dev/ttyUSB0" as a part of a file's name.
std::string file_name_of(const std::string& port) {
  std::error_code error;
  std::string name = fs::absolute(port, error).string();
  for (char& c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (!plain) c = '_';
  }
  constexpr std::size_t kLongest = 100;
  if (name.size() > kLongest) name.erase(0, name.size() - kLongest);
  return "board" + name;
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

KeptRun::KeptRun(host::Link& link, host::Clock& clock, KeptRunOptions options)
    : link_(link), clock_(clock), options_(std::move(options)) {}

Result<std::unique_ptr<KeptRun>> KeptRun::begin(host::Link& link, host::Clock& clock,
                                                KeptRunOptions options) {
  std::unique_ptr<KeptRun> run(new KeptRun(link, clock, std::move(options)));
  const KeptRunOptions& o = run->options_;
  run->ended_ = true;  // until it is known what to put back
  run->kept_.verb = o.verb;
  run->kept_.port = o.port;
  run->kept_.board = KAZ_TRY(host::read_board(link, clock, o.address));
  if (o.flash || o.alone) {
    auto others = KAZ_TRY(host::find_boards(link, clock));
    std::erase(others, o.address);
    if (o.alone && !others.empty())
      return fail(Fault::usage, "other boards are on " + o.port + ", at " +
                                    host::addresses_text(others) +
                                    ", and this run disturbs every board on its line: connect the "
                                    "one at address " +
                                    std::to_string(o.address) + " alone");
    run->kept_.others = std::move(others);
  }
  run->ended_ = false;
  run->write_notes();
  if (!o.flash) return run;
  // From here on the board is altered: by a reset.
  if (auto read = host::read_flash(link, clock, run->kept_.board); !read)
    return tl::unexpected(together(std::move(read), run->end()).error());
  run->write_notes();
  return run;
}

// Only a second help: a run without them goes on.
void KeptRun::write_notes() {
  if (options_.folder.empty()) return;
  std::error_code error;
  fs::create_directories(options_.folder, error);
  // Process numbers repeat: notes that a killed run has left stay.
  const std::string begin =
      options_.folder + "/" + file_name_of(options_.port) + "-" + std::to_string(getpid());
  std::string path = path_.empty() ? begin + ".json" : path_;
  for (int n = 2; path_.empty() && fs::exists(fs::symlink_status(path, error)); ++n)
    path = begin + "-" + std::to_string(n) + ".json";
  if (const auto written = write_whole_file(path, kept_text(kept_)); written) {
    path_ = path;
  } else {
    std::fprintf(stderr, "%s: what the board was like before is not written down: %s\n",
                 options_.verb.c_str(), written.error().message.c_str());
  }
}

Result<void> KeptRun::put_back() {
  const auto back = host::put_back(link_, clock_, kept_.board,
                                   {.patience = options_.patience,
                                    .flash = options_.flash,
                                    .motors_off = options_.motors_off,
                                    .others = kept_.others});
  for (const std::string& note : back.notes)
    std::fprintf(stderr, "%s: %s\n", options_.verb.c_str(), note.c_str());
  if (back.left.empty()) {
    if (!back.done.empty())
      std::fprintf(stderr, "%s: put back on %s: %s\n", options_.verb.c_str(), options_.port.c_str(),
                   joined(back.done).c_str());
    return {};
  }
  const std::string command = path_.empty() ? "kaz recover " + options_.port + " --address " +
                                                  std::to_string(options_.address)
                                            : "kaz recover " + options_.port + " --from " + path_;
  return fail(Fault::environment, "the board on " + options_.port +
                                      " may not be as it was before; not put back: " +
                                      joined(back.left) + ": give `" + command + "`");
}

Result<void> KeptRun::end() {
  if (ended_) return {};
  ended_ = true;
  link_.ignore_interrupt();
  KAZ_TRY(put_back());
  std::error_code error;
  if (!path_.empty()) fs::remove(path_, error);
  return {};
}

KeptRun::~KeptRun() {
  try {
    if (const auto ended = end(); !ended)
      std::fprintf(stderr, "%s: %s\n", options_.verb.c_str(), ended.error().message.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: the board is not put back: %s\n", options_.verb.c_str(),
                 error.what());
  }
}

}  // namespace kaz::tools
