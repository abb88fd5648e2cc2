// A serial port of Linux as an object of the Web Serial API: as much of it as clients of servos use.
// SPDX-License-Identifier: Apache-2.0
import { execFileSync } from "node:child_process";
import { closeSync, constants, openSync, writeSync } from "node:fs";
import { ReadStream } from "node:tty";

export function openWebSerial(path, baud) {
  const fd = openSync(path, constants.O_RDWR | constants.O_NOCTTY | constants.O_NONBLOCK);
  execFileSync("stty", ["raw", "-echo", String(baud)], { stdio: [fd, "inherit", "inherit"] });
  const tty = new ReadStream(fd);
  const readable = new ReadableStream({
    start(controller) {
      tty.on("data", (data) => controller.enqueue(new Uint8Array(data)));
      tty.on("error", () => {});
      tty.on("close", () => { try { controller.close(); } catch { /* closed already */ } });
    },
  });
  const writable = new WritableStream({ write(bytes) { writeSync(fd, bytes); } });
  return { readable, writable, async close() { tty.destroy(); try { closeSync(fd); } catch { /* by the stream */ } } };
}
