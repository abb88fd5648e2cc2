// First process of a virtual machine: mounts, loads /modules, runs /test, prints how it ended.
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

namespace {

void mount_at(const char* kind, const char* place) {
  mkdir(place, 0755);
  if (mount(kind, place, kind, 0, nullptr) != 0)
    std::printf("init: no %s at %s: %s\n", kind, place, std::strerror(errno));
}

// Lines of /modules/list, in the order of loading: FILE PARAMETERS.
bool load_modules() {
  std::ifstream list("/modules/list");
  std::string line;
  while (std::getline(list, line)) {
    const std::size_t space = std::min(line.find(' '), line.size());
    const std::string file = "/modules/" + line.substr(0, space);
    const std::string parameters = space < line.size() ? line.substr(space + 1) : "";
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (syscall(SYS_finit_module, descriptor, parameters.c_str(), 0) != 0) {
      std::printf("init: %s: %s\n", file.c_str(), std::strerror(errno));
      return false;
    }
    close(descriptor);
  }
  return true;
}

int run_test() {
  const pid_t child = fork();
  if (child == 0) {
    execl("/test", "/test", "--gtest_color=no", static_cast<char*>(nullptr));
    std::printf("init: /test: %s\n", std::strerror(errno));
    _exit(126);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

int main() {
  if (getpid() != 1) {
    std::fprintf(stderr,
                 "this is the first process of a virtual machine: see tests/system/v4l2/run.py\n");
    return 2;
  }
  mount_at("proc", "/proc");
  mount_at("sysfs", "/sys");
  mount_at("devtmpfs", "/dev");
  mount_at("tmpfs", "/tmp");
  const int console = open("/dev/console", O_RDWR);
  for (int i = 0; i < 3; ++i) dup2(console, i);
  const int code = load_modules() ? run_test() : 125;
  std::printf("EXIT:%d\n", code);
  std::fflush(stdout);
  tcdrain(1);
  sync();
  reboot(RB_POWER_OFF);
}
