// Transport of GDB's remote protocol: local TCP, a Unix socket, or standard input and output.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "shared/base/result.hpp"
#include "sim/h8s/debug/gdb_server.h"

namespace kaz::h8s {

class GdbPort {
 public:
  // "PORT" (1..65535, on 127.0.0.1 only; 0: any free one), a path with a '/' (a Unix socket, created
  // here and removed at the end), or "-" (standard input and output: `target remote | COMMAND`).
  // Errors: not one of these, or the port or path is not available.
  static Result<GdbPort> open(const std::string& where);
  ~GdbPort();
  GdbPort(GdbPort&& other) noexcept;
  GdbPort& operator=(GdbPort&&) = delete;

  // The TCP port; 0 for the others.
  int port() const { return port_; }
  // The command to enter in GDB: "target remote localhost:1234".
  std::string hint() const;

  // One line for the user, without newline: a client was disconnected.
  using Report = std::function<void(const std::string&)>;

  // Waits for one GDB and serves it until it kills, detaches or closes the connection. Runs the
  // chip in slices of `slice` states and checks for Ctrl-C between them. Returns too when the descriptor
  // `stop` becomes readable (-1: none), also while GDB does not read its replies. A client that begins like
  // a web browser (browser_guard.hpp) or leaves without a byte is none: the next one is waited for. One that
  // has sent nothing, or only what may become a browser's request, gives way to the next one. Without
  // a descriptor for a client that waits, it tries again every 100 ms. Errors: the connection fails.
  Result<void> serve(GdbServer& server, States slice = 1'000'000, int stop = -1,
                     const Report& report = {});

 private:
  GdbPort() = default;
  int listener_ = -1;
  int port_ = 0;
  std::string path_;
  unsigned long inode_ = 0;  // of the socket at path_
  bool standard_ = false;
};

}  // namespace kaz::h8s
