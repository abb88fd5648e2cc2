// The protocol's own clients against --view: they understand it, and what one records is our recording.
// SPDX-License-Identifier: Apache-2.0
// node clients.mjs KAZ FOLDER. They offer the older name of the protocol alone.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { client, killAll, messages, start, viewOf } from "./testing.mjs";

const [kaz, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });

try {
  const run = start(kaz, ["run", "search-ball", "--mcu", "native", "--out", `${folder}/run`, "--pace", "1", "--view-wait",
    "--view", "127.0.0.1:0"]);
  const url = await viewOf(run);
  const recorder = client("mcap-record", url, "-o", `${folder}/theirs.mcap`, "-n");
  await recorder.says(/subscribing to/);
  const simple = client("simple-client", url);
  const parameters = client("param-client", url);
  assert.equal(await run.ended, 0, run.text);
  await recorder.ended;
  assert.match(simple.text, /behavior: 'search-ball'/);
  assert.match(parameters.text, /Subscribing to 3 parameters/);
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
  killAll();
}
