// Instructions of a physics step and of finding contacts: body_benchmark under valgrind's callgrind.
// SPDX-License-Identifier: Apache-2.0
#include "tools/benchmark/benchmark.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "shared/base/files.hpp"
#include "shared/base/shell_word.hpp"
#include "tools/benchmark/body/names.h"

namespace kaz::bench {
namespace {

namespace fs = std::filesystem;

// A dump of callgrind says `desc: Trigger: Client Request: NAME=TIMES` and `totals: N`.
void take_dump(const fs::path& dump, Results& results) {
  const std::string request = "desc: Trigger: Client Request: ", totals = "totals: ";
  std::ifstream file(dump);
  std::string line, name;
  double times = 0;
  while (std::getline(file, line)) {
    if (line.compare(0, request.size(), request) == 0) {
      const std::size_t equals = line.rfind('=');
      if (equals == std::string::npos) return;
      name = line.substr(request.size(), equals - request.size());
      times = std::atof(line.c_str() + equals + 1);
    } else if (line.compare(0, totals.size(), totals) == 0 && times > 0) {
      results.put(name, std::atof(line.c_str() + totals.size()) / times / 1e3);
      return;
    }
  }
}

Result<void> count(const Settings& settings, Results& results) {
  if (settings.quick) return {};
  std::error_code error;
  const fs::path program =
      fs::read_symlink("/proc/self/exe", error).parent_path() / "body_benchmark";
  if (!fs::exists(program)) return {};  // said where its times are taken
  const auto made = KAZ_TRY(make_temporary_folder("kaz-bench-count-"));
  const fs::path folder = made;
  const std::string command =
      "valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=" +
      shell_word((folder / "dump").string()) + " " + shell_word(program.string()) +
      " --count >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  for (const auto& dump : fs::directory_iterator(folder, error)) take_dump(dump.path(), results);
  fs::remove_all(folder, error);
  results.remark(status == 0 ? "dynamics.*_kinstr: counted by valgrind's callgrind"
                             : "dynamics.*_kinstr are left out: valgrind is missing "
                               "(apt-get install valgrind) or failed");
  return {};
}

}  // namespace

Group counted_steps() {
  Group group;
  for (const char* load : sim::bench::kLoads) {
    for (const char* stepper : sim::bench::kSteppers)
      group.gives.push_back(sim::bench::name_of("step_kinstr", load, stepper));
    group.gives.push_back(sim::bench::name_of("collision_kinstr", load));
  }
  group.run = count;
  return group;
}

}  // namespace kaz::bench
