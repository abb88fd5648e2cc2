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

  // Function that is called after a client was rejected. The argument is one line of text for the user,
  // without newline.
  using Report = std::function<void(const std::string&)>;

  // Waits for a connection from GDB. Serves GDB until GDB kills the program, detaches or closes the
  // connection. Runs the chip in slices of `slice` states and checks for Ctrl-C between two slices. Also
  // returns when the file descriptor `stop` becomes readable, even if GDB has not yet read all replies. If
  // `stop` is -1, there is no such descriptor. Error: the connection fails.
  //
  // A client is rejected if its first bytes look like the request of a web browser (browser_guard.hpp). If a
  // client was rejected, or has disconnected before its first packet was complete, the function waits for the
  // next client. If a new client connects before the current client has sent a complete packet, the new
  // client replaces the current client. As long as a client's first packet is incomplete, the client may be
  // GDB or a web browser. If a client cannot be accepted, for example because no file descriptor is free,
  // the function retries every 100 ms.
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
