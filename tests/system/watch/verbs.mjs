// Every verb that has --view, seen by a client of the protocol: a simulator, a robot at a port, a board at a
// port, a motor stand, an evaluation, and the recording of a run at a port.
// SPDX-License-Identifier: Apache-2.0
// node verbs.mjs KAZ FOLDER
import assert from "node:assert/strict";
import { mkdirSync, rmSync } from "node:fs";
import { client, killAll, messages, start, until, viewOf } from "./testing.mjs";

const [kaz, folder] = process.argv.slice(2);
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });

// By topic the messages that a client of the protocol got: of all topics `wanted`, and of /tf 6.
async function seen(program, name, ...wanted) {
  for (let seconds = 2;; seconds *= 2) {
    const topics = await seenFor(program, name, seconds);
    const missing = [...wanted, "/tf"].filter((topic) => !(topics.get(topic)?.length > (topic === "/tf" ? 5 : 0)));
    if (missing.length === 0) return topics;
    assert(seconds < 200 && program.child.exitCode === null,
      `${name}: nothing, or too little, of ${missing}: ${program.text}`);
  }
}
async function seenFor(program, name, seconds) {
  const path = `${folder}/${name}.mcap`;
  const recorder = client("mcap-record", await viewOf(program), "-o", path, "-n");
  await recorder.says(/subscribing to/);
  await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
  await recorder.stop();
  const topics = messages(path);
  console.log(`${name}: ${[...topics].map(([topic, list]) => `${topic} ${list.length}`).join(", ")}`);
  return topics;
}

// Height of the trunk in a tf2_msgs/TFMessage, m.
function trunkHeight(data) {
  let at = 4;
  const text = () => { const size = data.readUInt32LE(at); at += 4 + size; return data.toString("latin1", at - size, at); };
  for (let left = data.readUInt32LE(0); left > 0; --left) {
    at += 12;  // seq, stamp
    text();
    const frame = text();
    if (frame === "trunk") return data.readDoubleLE(at + 16);
    at += 7 * 8;
  }
  throw new Error("no pose of the trunk");
}
const stands = (topics, name) => {
  const height = trunkHeight(topics.get("/tf").at(-1).data);
  assert(height > 0.1 && height < 0.2, `${name}: the trunk is at a height of ${height} m`);
};
const started = (words) => start(kaz, words, folder);
const view = ["--view", "127.0.0.1:0"];
try {
  const sim = started(["sim", "--mcu", "native", "--serial", "board", "--cameras", "eyes", ...view]);
  await sim.says(/ready:/);
  stands(await seen(sim, "sim", "/truth/joints", "/scene", "/board/state", "/eyes/left", "/eyes/right/camera_info"),
    "sim");

  const run = started(["run", "track-ball", "--robot", "serial:board", "--camera", "eyes", "--set", "seconds=600",
    "--out", "run", ...view]);
  const live = await seen(run, "run", "/wire/to_host", "/joint_states", "/board/state", "/eyes/left", "/behavior");
  stands(live, "run at a port");
  assert(!live.has("/truth/joints"), "a robot at a port has no truth");
  await run.stop();

  // A terminal is what `script` gives it.
  const monitor = start("script", ["-qec", `TERM=xterm ${kaz} monitor --port board ${view.join(" ")}`, "/dev/null"], folder);
  stands(await seen(monitor, "monitor", "/board/state", "/joint_states"), "monitor");
  await monitor.stop();
  assert.equal(await sim.stop(), 0, sim.text);

  const replay = started(["replay", "run/recording.mcap", ...view]);
  stands(await seen(replay, "recording of a port", "/board/state", "/behavior"), "recording of a port");
  assert.equal(await replay.stop(), 0, replay.text);

  const bench = started(["bench", "motor", "--mcu", "native", "--filter", "step", "--pace", "1", "--out", "bench",
    "--view-wait", ...view]);
  await seen(bench, "bench", "/joint_states", "/board/state");
  await bench.stop();

  const port = 20000 + process.pid % 20000;
  const evaluation = started(["evaluate", "track-ball", "--mcu", "native", "--set", "seconds=3", "--episodes", "2",
    "--jobs", "1", "--pace", "1", "--out", "evaluated", "--view-wait", "--view", `${port}`]);
  await evaluation.says(/watch the run at/);
  // The first episode's process takes the port over.
  await until(() => seen(evaluation, "evaluate", "/truth/joints", "/eyes/left", "/scene").catch(() => null),
    "an episode of evaluate is seen");
  await evaluation.stop();
  console.log("sim, run, monitor, replay, bench, evaluate: as they should be");
} finally {
  killAll();
}
