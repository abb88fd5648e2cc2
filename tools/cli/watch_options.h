// Options --view, --view-wait, --view-open and --pace, and functions that serve viewers during a run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "tools/bench/bench_run.h"
#include "tools/eval/campaign.h"
#include "tools/monitor/monitor.h"
#include "tools/replay/replay.h"
#include "tools/run/run.h"
#include "tools/sim/serve.h"

namespace kaz::tools {

struct WatchArguments {
  bool view = false, wait = false, open = false;
  std::string where;  // ADDRESS:PORT; empty: the default
  double pace = 0;    // maximum ratio of simulated time to real time; 0: no limit
};

// Adds the options. With `paced`, also adds --pace, which is only valid for a verb that does not follow a
// real clock. `arguments` must outlive `verb`.
void add_watch_options(CLI::App& verb, WatchArguments& arguments, bool paced = true);
// The five functions below call run(), serve(), run_bench(), monitor() and run_campaign(). If --view
// is given, the functions also run a server for viewers.
Result<bool> run_watched(const WatchArguments& arguments, RunOptions run_options);
Result<bool> serve_watched(const WatchArguments& arguments, ServeOptions serve);
Result<ExitStatus> bench_watched(const WatchArguments& arguments, BenchOptions bench);
Result<bool> monitor_watched(const WatchArguments& arguments, MonitorOptions monitor);
Result<bool> evaluate_watched(const WatchArguments& arguments, CampaignOptions campaign);
// Plays a recording for viewers until Ctrl-C.
Result<void> play_recording(const WatchArguments& arguments, const std::string& file);

}  // namespace kaz::tools
