// Programs that a test runs, what they print, and recordings.
// SPDX-License-Identifier: Apache-2.0
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { McapStreamReader } from "@mcap/core";

// The machine may be busy, and without a graphics card: this only ends a hang.
export const kHang_ms = 600000;

const running = new Set();
const examples = createRequire(import.meta.url).resolve("@foxglove/ws-protocol-examples");

// Asks every 0.1 s whether `condition` holds, which may be a promise. `state`: what the error shows besides the sentence.
export async function until(condition, sentence, state = () => "") {
  for (const began = Date.now(); Date.now() - began < kHang_ms;) {
    const value = await condition();
    if (value) return value;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  throw new Error(`never true: ${sentence}\n${state()}`);
}

// text: what it has printed; says(pattern): waits for it; ended: its exit status; stop(): Ctrl-C, and that.
export function start(program, words, cwd) {
  const child = spawn(program, words, { cwd, stdio: ["ignore", "pipe", "pipe"] });
  running.add(child);
  const result = { child, text: "" };
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (data) => { result.text += data; });
  result.ended = new Promise((resolve) => child.on("exit", (code) => { running.delete(child); resolve(code); }));
  result.says = (pattern) => until(() => {
    const found = pattern.exec(result.text);
    if (!found && child.exitCode !== null) throw new Error(`${words.join(" ")} did not print ${pattern}:\n${result.text}`);
    return found;
  }, `${words.join(" ")} prints ${pattern}`, () => result.text);
  result.stop = () => { child.kill("SIGINT"); return result.ended; };
  return result;
}

// A client of the protocol's own examples.
export const client = (...words) => start(process.execPath, [examples, ...words]);

// The address of the protocol that a program prints: with its token.
export const viewOf = async (program) =>
  `ws${(await program.says(/watch the run at http(:\/\/[\d.]+:\d+\/\?token=\w+)/))[1]}`;

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
