// A client of a board: its port is not there, and the error says so.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "host/behavior/behavior.h"
#include "host/link/port_address.h"
#include "host/link/port_link.h"

int main() {
  const auto address = kaz::host::parse_port_address("--robot", "serial:/nowhere");
  const auto port = kaz::host::open_port(*address, nullptr);
  std::printf("%zu behaviors; %s\n", kaz::behavior::behaviors().size(),
              port ? "a port?" : port.error().message.c_str());
  return port ? 1 : 0;
}
