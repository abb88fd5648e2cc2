// A link that a program opens by name, whatever carries its bytes: what verbs use.
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

class PortLink : public Link, public ModemLines {
 public:
  // Why a round trip may be slow.
  virtual LowLatency low_latency() const = 0;
  // Readable, as poll() understands it, when `read` has something to do; -1 while the link is gone. It may be
  // another one after reopen().
  virtual int descriptor() const = 0;
  // Whether `read` has something to do that descriptor() does not show: bytes that the other end has not
  // taken yet, which `read` sends, too, or bytes that have come already.
  virtual bool has_unsent() const { return false; }
  // Whether all bytes that were written have left the port, as far as the system can report that.
  virtual bool drained() const { return !has_unsent(); }
  // Discards bytes that were received and not read, or were written and have not left, where the link can.
  virtual void purge(bool /*received*/, bool /*unsent*/) {}
  // What the link has counted besides bytes, as a sentence: "3 error frames, bus-off once"; empty if nothing.
  virtual std::string counts() const { return ""; }
  // Of a bus of servos, those that have not confirmed that they are off, a sentence with what to do; else
  // empty.
  virtual std::string still_on() const { return ""; }
};

// Opens the port. Errors, each one sentence: what each kind of link lists. `interrupt` may be null; else it
// must outlive the link. Deadlines are on WallClock's scale.
Result<std::unique_ptr<PortLink>> open_port(const PortAddress& address,
                                            const Interrupt* interrupt = nullptr);

}  // namespace kaz::host
