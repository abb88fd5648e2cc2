// The protocol's own clients against --view: they understand it, and what one records is our recording.
// SPDX-License-Identifier: Apache-2.0
// node clients.mjs KAZ FOLDER. They offer the older name of the protocol alone.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { McapStreamReader } from "@mcap/core";

const [kaz, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const examples = createRequire(import.meta.url).resolve("@foxglove/ws-protocol-examples");
const running = new Set();

function start(program, words) {
  const child = spawn(program, words, { stdio: ["ignore", "pipe", "pipe"] });
  running.add(child);
  const result = { child, text: "" };
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (data) => { result.text += data; });
  result.ended = new Promise((resolve) => child.on("exit", (code) => { running.delete(child); resolve(code); }));
  result.says = async (pattern) => {
    for (let i = 0; i < 300; ++i) {
      const found = pattern.exec(result.text);
      if (found) return found;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    throw new Error(`${words.join(" ")} did not print ${pattern}:\n${result.text}`);
  };
  return result;
}
const client = (...words) => start(process.execPath, [examples, ...words]);

// topic -> its messages, each as time and content.
function messages(path) {
  const reader = new McapStreamReader({ validateCrcs: false });
  reader.append(readFileSync(path));
  const topics = new Map(), channels = new Map();
  for (let record; (record = reader.nextRecord());) {
    if (record.type === "Channel") channels.set(record.id, record.topic);
    if (record.type !== "Message") continue;
    const topic = channels.get(record.channelId);
    if (!topics.has(topic)) topics.set(topic, []);
    topics.get(topic).push(`${record.publishTime} ${Buffer.from(record.data).toString("base64")}`);
  }
  return topics;
}

try {
  const run = start(kaz, ["run", "search-ball", "--mcu", "native", "--out", `${folder}/run`, "--pace", "1", "--view-wait",
    "--view", "127.0.0.1:0"]);
  const [, port] = await run.says(/watch it at http:\/\/127\.0\.0\.1:(\d+)/);
  const url = `ws://127.0.0.1:${port}`;
  const recorder = client("mcap-record", url, "-o", `${folder}/theirs.mcap`, "-n");
  await recorder.says(/subscribing to/);
  const simple = client("simple-client", url);
  const parameters = client("param-client", url);
  assert.equal(await run.ended, 0, run.text);
  await recorder.ended;
  assert.match(simple.text, /behavior: 'search-ball'/);
  assert.match(parameters.text, /Subscribing to 2 parameters/);
  for (const other of [simple, parameters]) other.child.kill();

  const ours = messages(`${folder}/run/recording.mcap`), theirs = messages(`${folder}/theirs.mcap`);
  let compared = 0;
  for (const [topic, list] of ours) {
    assert.equal(theirs.get(topic)?.length, list.length, `messages of ${topic}`);
    assert.deepEqual(theirs.get(topic), list, topic);
    compared += list.length;
  }
  for (const topic of ["/tf", "/joint_states", "/scene", "/robot_description", "/board/state"])
    assert(theirs.get(topic)?.length > 0, `nothing of ${topic}`);
  console.log(`${compared} messages of ${ours.size} channels are those of the recording`);
} finally {
  for (const child of running) child.kill("SIGKILL");
}
