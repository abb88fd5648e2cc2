// First process of a virtual machine: mounts, loads /modules, runs what the console says, one line at a time.
// SPDX-License-Identifier: Apache-2.0
//
// The root of the machine outside, read-only, becomes the root for the commands; one folder of it, for
// results, is /mnt. After each command EXIT:STATUS is printed; `poweroff` ends the machine (machine.py).
#include <fcntl.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>

namespace {

bool mount_at(const char* kind, const char* what, const std::string& place, unsigned long flags = 0,
              const char* options = nullptr) {
  mkdir(place.c_str(), 0755);
  if (mount(what, place.c_str(), kind, flags, options) == 0) return true;
  std::printf("init: no %s at %s: %s\n", what, place.c_str(), std::strerror(errno));
  return false;
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

bool enter_root() {
  const char* const kOptions = "trans=virtio,version=9p2000.L,msize=262144";
  bool good =
      mount_at("9p", "root", "/root", MS_RDONLY,
               (std::string(kOptions) + ",cache=loose").c_str()) &&
      mount_at("9p", "out", "/root/mnt", 0, kOptions) && mount_at("proc", "proc", "/root/proc") &&
      mount_at("sysfs", "sysfs", "/root/sys") && mount_at("devtmpfs", "devtmpfs", "/root/dev") &&
      mount_at("devpts", "devpts", "/root/dev/pts", 0, "ptmxmode=0666") &&
      mount_at("tmpfs", "tmpfs", "/root/dev/shm") && mount_at("tmpfs", "tmpfs", "/root/run");
  return good && chroot("/root") == 0 && chdir("/mnt") == 0;
}

// On a console without echo: what is printed is the commands' alone.
void open_console() {
  const int console = open("/dev/console", O_RDWR);
  for (int i = 0; i < 3; ++i) dup2(console, i);
  termios settings{};
  if (tcgetattr(0, &settings) != 0) return;
  settings.c_lflag &= ~static_cast<tcflag_t>(ECHO);
  settings.c_oflag &= ~static_cast<tcflag_t>(OPOST);
  tcsetattr(0, TCSANOW, &settings);
}

int run(const std::string& line) {
  const pid_t child = fork();
  if (child == 0) {
    setsid();
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, 0);
    execl("/bin/sh", "/bin/sh", "-c", line.c_str(), static_cast<char*>(nullptr));
    std::printf("init: /bin/sh: %s\n", std::strerror(errno));
    _exit(126);
  }
  int status = 0;
  // Commands may leave others behind, which end at any time.
  for (pid_t ended = 0; ended != child;) {
    ended = wait(&status);
    if (ended < 0 && errno != EINTR) return 125;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void serve() {
  std::printf("READY\n");
  std::fflush(stdout);
  std::string line;
  while (std::getline(std::cin, line) && line != "poweroff") {
    const int code = run(line);
    std::printf("\nEXIT:%d\n", code);
    std::fflush(stdout);
  }
}

}  // namespace

int main() {
  if (getpid() != 1) {
    std::fprintf(
        stderr,
        "this is the first process of a virtual machine: see tests/system/guest/machine.py\n");
    return 2;
  }
  open_console();
  setenv("PATH", "/usr/sbin:/usr/bin:/sbin:/bin", 1);
  setenv("HOME", "/mnt", 1);
  setenv("TMPDIR", "/mnt", 1);
  if (load_modules() && enter_root()) serve();
  std::fflush(stdout);
  tcdrain(1);
  sync();
  reboot(RB_POWER_OFF);
}
