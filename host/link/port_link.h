// Interface of the links that a program opens by a port address: serial ports, CAN, TCP and servo buses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "host/link/interrupt.h"
#include "host/link/link.h"
#include "host/link/modem_lines.h"
#include "host/link/port_address.h"
#include "host/link/serial_port.h"

namespace kaz::host {

// A Link with a descriptor for poll(), modem lines, and diagnostics.
class PortLink : public Link, public ModemLines {
 public:
  // Returns the low-latency mode of the port, which may explain a slow round trip.
  virtual LowLatency low_latency() const = 0;
  // Descriptor for poll(). The descriptor becomes readable when `read` has work to do. The function returns
  // -1 while the link is lost. The descriptor may change in reopen().
  virtual int descriptor() const = 0;
  // Whether to call `read` although descriptor() is not readable. Reason: the link still has bytes to send,
  // or has received bytes that `read` has not returned.
  virtual bool has_unsent() const { return false; }
  // Whether all written bytes have left the port, as far as the operating system reports.
  virtual bool drained() const { return !has_unsent(); }
  // Discards received bytes that were not read, or written bytes that were not sent. Does nothing if the link
  // cannot discard bytes.
  virtual void purge(bool /*received*/, bool /*unsent*/) {}
  // Counts of irregular events as a text, such as "3 error frames, bus-off once"; empty if no such event
  // occurred.
  virtual std::string counts() const { return ""; }
  // For a servo bus: a sentence that lists the servos whose torque may still be on, and names the remedy. The
  // sentence is empty for other links.
  virtual std::string still_on() const { return ""; }
};

// Opens the port. Returns the errors of the link type that `address` selects. Each error message is one
// sentence. `interrupt` may be null; else `interrupt` must outlive the link. Deadlines are on WallClock's
// scale.
Result<std::unique_ptr<PortLink>> open_port(const PortAddress& address,
                                            const Interrupt* interrupt = nullptr);

}  // namespace kaz::host
