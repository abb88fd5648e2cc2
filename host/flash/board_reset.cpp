// Resets by modem lines, by the simulator's control socket, by hand.
// SPDX-License-Identifier: Apache-2.0
#include "host/flash/board_reset.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace kaz::host {

Result<void> ModemLineReset::reset(bool boot) {
  static constexpr Time kStep = std::chrono::milliseconds(25);
  const auto wait = [this] { return clock_.sleep_until(clock_.now() + kStep); };
  if (auto set = port_.set_dtr_rts(true, boot); !set) return set;
  if (auto waited = wait(); !waited) return waited;
  // The mode pins are looked at as RES goes up.
  if (auto set = port_.set_dtr_rts(false, boot); !set) return set;
  return wait();
}

Result<void> ControlSocketReset::command(const std::string& line) const {
  const auto trouble = [&](const std::string& why) {
    return fail(Fault::environment, "control socket " + path_ + ": " + why +
                                        "; is `kaz sim --serial …` running, and is this its .ctl?");
  };
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path_.size() >= sizeof address.sun_path) return trouble("the path is too long");
  std::memcpy(address.sun_path, path_.c_str(), path_.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return trouble(std::strerror(errno));
  const timeval patience{5, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string reply;
  std::string why;
  const std::string request = line + "\n";
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      send(fd, request.data(), request.size(), MSG_NOSIGNAL) !=
          static_cast<ssize_t>(request.size())) {
    why = std::strerror(errno);
  }
  while (why.empty() && reply.find('\n') == std::string::npos) {
    char piece[512];
    const ssize_t count = recv(fd, piece, sizeof piece, 0);
    if (count <= 0) {
      why = "no reply to `" + line + "`";
    } else {
      reply.append(piece, static_cast<std::size_t>(count));
    }
  }
  close(fd);
  if (!why.empty()) return trouble(why);
  if (reply.find("\"ok\":true") == std::string::npos)
    return trouble("`" + line + "` was refused: " + reply.substr(0, reply.find('\n')));
  return {};
}

Result<void> ControlSocketReset::reset(bool boot) {
  if (auto set = command(boot ? "mode boot" : "mode run"); !set) return set;
  return command("reset");
}

Result<void> ManualReset::reset(bool boot) {
  return ask_(boot ? "Set the board's switch to boot mode (MD1, MD0 low) and press its reset button"
                   : "Set the board's switch back to run (MD1 high) and press its reset button");
}

}  // namespace kaz::host
