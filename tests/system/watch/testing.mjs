// Programs that a test runs, what they print, and recordings.
// SPDX-License-Identifier: Apache-2.0
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { McapStreamReader } from "@mcap/core";

const running = new Set();
const examples = createRequire(import.meta.url).resolve("@foxglove/ws-protocol-examples");

// text: what it has printed; says(pattern): waits for it; ended: its exit status; stop(): Ctrl-C, and that.
export function start(program, words, cwd) {
  const child = spawn(program, words, { cwd, stdio: ["ignore", "pipe", "pipe"] });
  running.add(child);
  const result = { child, text: "" };
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (data) => { result.text += data; });
  result.ended = new Promise((resolve) => child.on("exit", (code) => { running.delete(child); resolve(code); }));
  result.says = async (pattern) => {
    for (let i = 0; i < 400; ++i) {
      const found = pattern.exec(result.text);
      if (found) return found;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    throw new Error(`${words.join(" ")} did not print ${pattern}:\n${result.text}`);
  };
  result.stop = () => { child.kill("SIGINT"); return result.ended; };
  return result;
}

// A client of the protocol's own examples.
export const client = (...words) => start(process.execPath, [examples, ...words]);

// The address of the protocol that a program prints: with its token.
export const viewOf = async (program) =>
  `ws${(await program.says(/watch it at http(:\/\/[\d.]+:\d+\/\?token=\w+)/))[1]}`;

export function killAll() {
  for (const child of running) child.kill("SIGKILL");
}

// By topic its messages: { time, data }, ns.
export function messages(path) {
  const reader = new McapStreamReader({ validateCrcs: false });
  reader.append(readFileSync(path));
  const topics = new Map(), channels = new Map();
  for (let record; (record = reader.nextRecord());) {
    if (record.type === "Channel") channels.set(record.id, record.topic);
    if (record.type !== "Message") continue;
    const topic = channels.get(record.channelId);
    if (!topics.has(topic)) topics.set(topic, []);
    topics.get(topic).push({ time: record.publishTime, data: Buffer.from(record.data) });
  }
  return topics;
}
