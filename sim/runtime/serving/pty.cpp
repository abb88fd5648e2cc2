// Opens a pseudo-terminal and detects whether a host has it open.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/pty.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "shared/base/serial_rates.hpp"

namespace kaz::sim {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> no_pty(const char* what) {
  return fail(Fault::environment, std::string("cannot make a pseudo-terminal: ") + what + ": " +
                                      std::strerror(errno) + "; check that /dev/pts is mounted");
}

bool is_pty_name(const std::string& target) {
  constexpr std::string_view folder = "/dev/pts/";
  return target.starts_with(folder) && target.size() > folder.size() &&
         std::all_of(target.begin() + folder.size(), target.end(),
                     [](char c) { return c >= '0' && c <= '9'; });
}

// Whether the link is stale, i.e. left by a virtual board, and may be removed. Our links point to exactly
// /dev/pts/N; all others belong to other programs. Pty numbers are reused, so such a link is stale if there
// is no such pty, if the number is now our own, or if its maker is known to be dead. Otherwise it may be
// the port of another program (socat, another simulator).
bool is_left_over(const std::string& target, const std::string& own, bool maker_is_dead) {
  std::error_code error;
  return is_pty_name(target) && (target == own || maker_is_dead || !fs::exists(target, error));
}

Result<void> make_link(const std::string& target, const std::string& link, bool maker_is_dead) {
  std::error_code error;
  const auto status = fs::symlink_status(link, error);
  if (fs::is_symlink(status)) {
    const std::string there = fs::read_symlink(link, error).string();
    if (error || !is_left_over(there, target, maker_is_dead))
      return fail(Fault::usage, link + " is a symbolic link to " + there +
                                    ", which no virtual board created; choose another path for the "
                                    "serial port, or remove the link");
    fs::remove(link, error);
  } else if (fs::exists(status)) {
    return fail(Fault::usage, link +
                                  " exists and is not a symbolic link; choose another path for " +
                                  "the serial port, or remove the file");
  }
  // Fails if the path was created meanwhile.
  fs::create_symlink(target, link, error);
  if (error)
    return fail(Fault::environment,
                "cannot link " + link + " to the serial port " + target + ": " + error.message());
  return {};
}

}  // namespace

Result<std::unique_ptr<Pty>> Pty::open(const std::string& link_path, bool maker_is_dead) {
  std::unique_ptr<Pty> pty(new Pty);
  pty->master_ = Descriptor(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  const int master = pty->master_.get();
  if (master < 0) return no_pty("posix_openpt");
  char name[128];
  if (grantpt(master) != 0 || unlockpt(master) != 0 || ptsname_r(master, name, sizeof name) != 0)
    return no_pty("unlocking it");
  pty->port_ = name;

  // Opened and closed once: from then on the master reports a hang-up exactly while no host has it open.
  const Descriptor slave(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (!slave || tcgetattr(slave.get(), &settings) != 0) return no_pty(name);
  cfmakeraw(&settings);
  cfsetspeed(&settings, B115200);
  if (tcsetattr(slave.get(), TCSANOW, &settings) != 0) return no_pty(name);

  KAZ_TRY(make_link(pty->port_, link_path, maker_is_dead));
  pty->link_ = link_path;
  return pty;
}

Pty::~Pty() {
  if (link_.empty()) return;
  std::error_code error;
  if (fs::read_symlink(link_, error) == port_) fs::remove(link_, error);
}

bool Pty::host_present() const {
  pollfd poll_master{master_.get(), POLLIN, 0};
  return poll(&poll_master, 1, 0) >= 0 && (poll_master.revents & POLLHUP) == 0;
}

long Pty::baud() const {
  termios settings{};
  if (tcgetattr(master_.get(), &settings) != 0) return 0;  // the master shares the slave's settings
  for (const auto& [baud, code] : kSerialRates)
    if (code == cfgetospeed(&settings)) return baud;
  return 0;
}

void Pty::wait(Time length, bool host_present) const {
  const timespec time{static_cast<time_t>(length.count() / 1'000'000'000),
                      static_cast<long>(length.count() % 1'000'000'000)};
  // Without a host the master is always readable (hang-up). A signal may end the wait early.
  pollfd master{master_.get(), POLLIN, 0};
  ppoll(&master, host_present ? 1 : 0, &time, nullptr);
}

std::size_t Pty::read(std::span<std::uint8_t> bytes) {
  const ssize_t count = ::read(master_.get(), bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;  // EIO: no host; EAGAIN: nothing there
}

std::size_t Pty::write(std::span<const std::uint8_t> bytes) {
  const ssize_t count = ::write(master_.get(), bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void Pty::discard_unread() {
  // Unread bytes are in the input queue of the slave side.
  const Descriptor slave(::open(port_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  if (slave) tcflush(slave.get(), TCIFLUSH);
}

}  // namespace kaz::sim
