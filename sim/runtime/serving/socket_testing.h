// For tests: a client of the simulator's sockets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cstring>
#include <string>

#include "shared/base/descriptor.hpp"

namespace kaz::sim {

inline Descriptor unconnected() {
  return Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
}

// Connects to the socket at `path`. Returns an empty descriptor if no process listens at `path`.
inline Descriptor connect_to(const std::string& path, Descriptor socket = unconnected()) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return {};
  return socket;
}

}  // namespace kaz::sim
