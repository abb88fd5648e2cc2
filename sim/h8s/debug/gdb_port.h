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
  // Opens one of three transports:
  // - "PORT": TCP port 1..65535 on 127.0.0.1 only, or 0 for any free port.
  // - A path with a '/': a Unix socket, which is created and removed by this object.
  // - "-": standard input and output, for `target remote | COMMAND`.
  // Errors: `where` has another form, or the port or path is not available.
  static Result<GdbPort> open(const std::string& where);
  ~GdbPort();
  GdbPort(GdbPort&& other) noexcept;
  GdbPort& operator=(GdbPort&&) = delete;

  // Returns the TCP port; 0 for other transports.
  int port() const { return port_; }
  // Returns the command to enter in GDB, such as "target remote localhost:1234".
  std::string hint() const;

  // Receives one line for the user, without newline, when a client was rejected.
  using Report = std::function<void(const std::string&)>;

  // Waits for one GDB and serves it until it kills the program, detaches or closes the connection. Runs the
  // chip in slices of `slice` states and checks for Ctrl-C between them. Also returns when the descriptor
  // `stop` becomes readable (-1: none), even if GDB does not read its replies. Error: the connection fails.
  //
  // A client that begins like a web browser (browser_guard.hpp) is rejected. After it, or after a client that
  // closes without sending a byte, the function waits for the next one. A new client replaces one that has
  // sent nothing, or only bytes that may begin a browser's request. If a client cannot be accepted, for
  // example without a free descriptor, the function retries every 100 ms.
  Result<void> serve(GdbServer& server, States slice = 1'000'000, int stop = -1,
                     const Report& report = {});

 private:
  GdbPort() = default;
  int listener_ = -1;
  int port_ = 0;
  std::string path_;
  unsigned long inode_ = 0;  // inode of the socket at path_
  bool standard_ = false;
};

}  // namespace kaz::h8s
