// termios, exclusive use and low latency, with an error message for each cause of failure.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/serial_port.h"

#include <fcntl.h>
#include <grp.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "shared/base/serial_rates.hpp"

namespace kaz::host {

namespace {

namespace fs = std::filesystem;

Result<speed_t> rate_of(int baud) {
  std::string known;
  for (const auto& [number, rate] : kSerialRates) {
    if (number == baud) return rate;
    known += (known.empty() ? "" : ", ") + std::to_string(number);
  }
  return fail(Fault::usage, std::to_string(baud) +
                                " baud is not supported by serial ports here; use one of " + known);
}

// The kernel makes /dev/ttyS* for UARTs that may not exist; those have type 0.
bool has_hardware(const std::string& name) {
  if (name.rfind("ttyS", 0) != 0) return true;
  std::ifstream file("/sys/class/tty/" + name + "/type");
  int type = 0;
  return (file >> type) && type != 0;
}

std::string candidates_sentence() {
  const auto ports = serial_port_candidates();
  if (ports.empty()) return "no serial port was found; plug the adapter in, or start `kaz sim`";
  std::string text = "ports found: ";
  for (std::size_t i = 0; i < ports.size(); ++i) text += (i ? ", " : "") + ports[i];
  return text;
}

// idVendor or idProduct of the USB device that a port belongs to; empty if it is none.
std::string usb_number(const std::string& path, const char* which) {
  std::error_code error;
  const fs::path port = fs::canonical(path, error);
  fs::path folder = fs::canonical("/sys/class/tty" / port.filename() / "device", error);
  for (int up = 0; !error && up < 4 && folder.has_relative_path(); ++up) {
    std::ifstream file(folder / which);
    std::string number;
    if (file >> number) return number;
    folder = folder.parent_path();
  }
  return "";
}

// The control socket of a virtual board stands beside its port.
std::string socket_sentence(const std::string& path) {
  constexpr std::string_view kEnd = ".ctl";
  if (!path.ends_with(kEnd)) return path + " is a socket, not a serial port";
  const std::string port = path.substr(0, path.size() - kEnd.size());
  return path + " is the control socket of `kaz sim`; its serial port is " + port;
}

// Whether `path` is the link of a virtual board whose process has been killed: nobody serves the control
// socket that stands beside it. The number of its pty may be that of another board, or of a terminal, since.
bool is_left_over(const std::string& path) {
  std::error_code none;
  const std::string control = path + ".ctl";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (!fs::is_symlink(fs::symlink_status(path, none)) || !fs::is_socket(control, none) ||
      control.size() >= sizeof address.sun_path)
    return false;
  control.copy(address.sun_path, control.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  // Whatever else keeps us out (too many clients, permission) shows that it is served.
  const bool dead = fd >= 0 &&
                    connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 &&
                    errno == ECONNREFUSED;
  if (fd >= 0) close(fd);
  return dead;
}

tl::unexpected<Error> open_failure(const std::string& path, int error) {
  std::error_code ignored;
  if (fs::is_socket(path, ignored)) return fail(Fault::environment, socket_sentence(path));
  switch (error) {
    case ENOENT:
    case ENOTDIR:
    case ENXIO:
    case ENODEV:
      return fail(Fault::environment, "no such port: " + path + " (" + candidates_sentence() + ")");
    case EACCES:
    case EPERM:
      return fail(Fault::environment,
                  permission_sentence(path, usb_number(path, "idVendor"),
                                      usb_number(path, "idProduct"), group_with_access(path)));
    case EBUSY:
      return fail(Fault::environment,
                  path + " is in use by another program: end that program first");
    default:
      return fail(Fault::environment, "cannot open " + path + ": " + std::strerror(error));
  }
}

// Major numbers 136..143 are pseudo-terminals (Documentation/admin-guide/devices.txt). Exclusive
// mode would outlive a killed program there, because the simulator keeps the terminal open.
bool is_pseudo_terminal(int fd) {
  struct stat info {};
  if (fstat(fd, &info) != 0) return false;
  const auto number = major(info.st_rdev);
  return number >= 136 && number <= 143;
}

int configure(int fd, speed_t rate) {
  termios settings{};
  if (tcgetattr(fd, &settings) != 0) return errno;
  cfmakeraw(&settings);
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | PARENB);
  settings.c_cflag |= CLOCAL | CREAD | CS8;
  settings.c_iflag |= IGNBRK;
  settings.c_cc[VMIN] =
      1;  // so that read() without data (EAGAIN) differs from a disconnected port (0)
  settings.c_cc[VTIME] = 0;
  cfsetispeed(&settings, rate);
  cfsetospeed(&settings, rate);
  if (tcsetattr(fd, TCSANOW, &settings) != 0) return errno;
  tcflush(fd, TCIOFLUSH);
  return 0;
}

// FTDI adapters hold received bytes back for 16 ms by default; this sets the driver's low-latency flag. Not
// every driver supports it, and some set it without reporting it afterwards.
LowLatency request_low_latency(int fd) {
  serial_struct serial{};
  if (ioctl(fd, TIOCGSERIAL, &serial) != 0) return LowLatency::refused;
  serial.flags |= ASYNC_LOW_LATENCY;
  if (ioctl(fd, TIOCSSERIAL, &serial) != 0) return LowLatency::refused;
  if (ioctl(fd, TIOCGSERIAL, &serial) != 0) return LowLatency::refused;
  const auto flags = static_cast<unsigned>(serial.flags);
  return (flags & ASYNC_LOW_LATENCY) != 0 ? LowLatency::set : LowLatency::refused;
}

}  // namespace

std::vector<std::string> serial_port_candidates() {
  constexpr const char* kPrefixes[] = {"ttyUSB", "ttyACM", "ttyS"};
  std::vector<std::string> ports;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/dev", error)) {
    const std::string name = entry.path().filename();
    const bool serial = std::any_of(std::begin(kPrefixes), std::end(kPrefixes),
                                    [&](const char* prefix) { return name.rfind(prefix, 0) == 0; });
    if (serial && has_hardware(name)) ports.push_back(entry.path());
  }
  std::sort(ports.begin(), ports.end());
  return ports;
}

std::string group_with_access(const std::string& path) {
  struct stat status {};
  constexpr mode_t kBoth = S_IRGRP | S_IWGRP;
  if (::stat(path.c_str(), &status) != 0 || status.st_gid == 0 || (status.st_mode & kBoth) != kBoth)
    return "";
  const ::group* of = ::getgrgid(status.st_gid);
  return of != nullptr ? of->gr_name : "";
}

std::string permission_sentence(const std::string& path, const std::string& vendor,
                                const std::string& product, const std::string& group) {
  const std::string denied = "permission denied for " + path + ": ";
  if (!group.empty())
    return denied + "add yourself to its group (`sudo adduser $USER " + group +
           "`) and log in again";
  if (vendor.empty() || product.empty())
    return denied + "only root has access; run as root, or `sudo chgrp dialout " + path +
           " && sudo chmod 660 " + path + "`";
  return denied +
         "only root has access. Add yourself to the group dialout, and log in again. Add this line "
         "to /etc/udev/rules.d/70-kaz.rules, and plug the adapter in again: SUBSYSTEM==\"tty\", "
         "ATTRS{idVendor}==\"" +
         vendor + "\", ATTRS{idProduct}==\"" + product +
         "\", GROUP=\"dialout\", MODE=\"0660\", SYMLINK+=\"kaz\"";
}

Result<void> set_serial_rate(int descriptor, const std::string& path, int baud) {
  const auto rate = KAZ_TRY(rate_of(baud));
  termios settings{};
  bool done = tcgetattr(descriptor, &settings) == 0;
  cfsetispeed(&settings, rate);
  cfsetospeed(&settings, rate);
  done = done && tcsetattr(descriptor, TCSANOW, &settings) == 0;
  if (done) return {};
  return fail(Fault::environment, "cannot set " + path + " to " + std::to_string(baud) +
                                      " baud: " + std::strerror(errno));
}

Result<OpenPort> open_serial_port(const std::string& path, int baud) {
  const auto rate = KAZ_TRY(rate_of(baud));

  if (is_left_over(path))
    return fail(Fault::environment,
                path +
                    " was left behind by a `kaz sim` that was killed: start it again with "
                    "--serial " +
                    path + ", or remove " + path + " and " + path + ".ctl");
  const int fd = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return open_failure(path, errno);
  if (!isatty(fd)) {
    close(fd);
    return fail(Fault::environment, path + " is not a serial port (" + candidates_sentence() + ")");
  }
  // The lock keeps programs of ours apart, and ends with the process however it ends.
  if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
    close(fd);
    return open_failure(path, EBUSY);
  }
  LowLatency low_latency = LowLatency::pseudo_terminal;
  if (!is_pseudo_terminal(fd)) {
    ioctl(fd, TIOCEXCL);
    low_latency = request_low_latency(fd);
  }
  if (const int error = configure(fd, rate)) {
    close(fd);
    return fail(Fault::environment, "cannot set " + path + " to " + std::to_string(baud) +
                                        " baud 8N1: " + std::strerror(error));
  }
  return OpenPort{fd, low_latency};
}

}  // namespace kaz::host
