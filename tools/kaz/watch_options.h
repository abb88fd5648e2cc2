// The options --view, --view-wait and --pace.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/app/replay/replay.h"
#include "tools/app/session/session.h"

namespace kaz::tools {

struct WatchArguments {
  bool view = false, wait = false;
  std::string where;  // ADDRESS:PORT; empty: the usual one
  double pace = 0;    // 0: as fast as it goes
};

void add_watch_options(CLI::App& verb, WatchArguments& arguments);
// run_session(), for viewers if the options say so.
Result<bool> run_watched(const WatchArguments& arguments, SessionOptions session);
// The recording, played for viewers until Ctrl-C.
Result<void> play_recording(const WatchArguments& arguments, const std::string& file);

}  // namespace kaz::tools
