// Runs a script (tools/board_page/script.h) on a board and prints what it did: on this machine, and on node.
// SPDX-License-Identifier: Apache-2.0
//
// board_script [--image FILE] [--engine NAME] [--no-noise] [--speed SECONDS] SCRIPT
// --speed: afterwards that much board time, and on stderr how fast it was.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "board_params.h"
#include "tools/board_page/script.h"
#include "tools/board_page/session.h"

namespace {

using kaz::board_page::Session;
using kaz::board_page::SessionOptions;

int complain(const std::string& what) {
  std::fprintf(stderr, "board_script: %s\n", what.c_str());
  return 1;
}

kaz::Result<double> measured_speed(Session& session, double seconds) {
  const auto before = std::chrono::steady_clock::now();
  for (int i = 0; i < 1000 * seconds; ++i) {
    KAZ_TRY(session.step());
    session.take_line();
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
  return seconds / took.count();
}

}  // namespace

int main(int argc, char** argv) {
  std::string image = "/kaz.mot", script;
  SessionOptions options{.motor = kaz::board_page::motor_params(),
                         .sensors = kaz::board_page::sensor_params()};
  double speed_s = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--no-noise") {
      options.noise = false;
    } else if (word == "--image" && i + 1 < argc) {
      image = argv[++i];
    } else if (word == "--speed" && i + 1 < argc) {
      speed_s = std::atof(argv[++i]);
    } else if (word == "--engine" && i + 1 < argc) {
      const std::string name = argv[++i];
      for (const auto engine : {kaz::h8s::Engine::reference, kaz::h8s::Engine::interpreter,
                                kaz::h8s::Engine::translator}) {
        if (name == kaz::h8s::name_of(engine)) options.engine = engine;
      }
    } else if (word.starts_with("--")) {
      return complain("no option " + word);
    } else {
      script = word;
    }
  }
  auto session = Session::begin(image, options);
  if (!session) return complain(session.error().message);
  const auto output = run_script(**session, script);
  if (!output) return complain(output.error().message);
  std::fputs(output->c_str(), stdout);
  if (speed_s > 0) {
    const auto speed = measured_speed(**session, speed_s);
    if (!speed) return complain(speed.error().message);
    std::fprintf(stderr, "speed %.2f x real time\n", *speed);
  }
  return 0;
}
