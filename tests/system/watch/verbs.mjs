// Every verb that has --view, seen by a client of the protocol: a simulator, a robot at a port, a board at a
// port, a motor stand, an evaluation, and the recording of a run at a port.
// SPDX-License-Identifier: Apache-2.0
// node verbs.mjs KAZ FOLDER
import assert from "node:assert/strict";
import { mkdirSync, rmSync } from "node:fs";
import { client, killAll, messages, start, viewOf } from "./testing.mjs";

const [kaz, folder] = process.argv.slice(2);
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });

// By topic the messages that a client of the protocol got in `seconds`.
async function seen(program, name, seconds) {
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
  const poses = topics.get("/tf");
  assert(poses?.length > 5, `${name}: poses`);
  const height = trunkHeight(poses.at(-1).data);
  assert(height > 0.1 && height < 0.2, `${name}: the trunk is at a height of ${height} m`);
};
const has = (topics, name, ...wanted) => {
  for (const topic of wanted) assert(topics.get(topic)?.length > 0, `${name}: nothing of ${topic}`);
};

const started = (words) => start(kaz, words, folder);
const view = ["--view", "127.0.0.1:0"];
try {
  const sim = started(["sim", "--mcu", "native", "--serial", "board", "--cameras", "eyes", ...view]);
  await sim.says(/ready:/);
  const served = await seen(sim, "sim", 2);
  stands(served, "sim");
  has(served, "sim", "/truth/joints", "/scene", "/board/state", "/eyes/left", "/eyes/right/camera_info");

  const run = started(["run", "track-ball", "--robot", "serial:board", "--camera", "eyes", "--set", "seconds=6",
    "--out", "run", ...view]);
  const live = await seen(run, "run", 3);
  stands(live, "run at a port");
  has(live, "run at a port", "/wire/to_host", "/joint_states", "/board/state", "/eyes/left", "/behavior");
  assert(!live.has("/truth/joints"), "a robot at a port has no truth");
  await run.ended;

  // A terminal is what `script` gives it.
  const monitor = start("script", ["-qec", `TERM=xterm ${kaz} monitor --port board ${view.join(" ")}`, "/dev/null"], folder);
  const board = await seen(monitor, "monitor", 2);
  stands(board, "monitor");
  has(board, "monitor", "/board/state", "/joint_states");
  await monitor.stop();
  assert.equal(await sim.stop(), 0, sim.text);

  const replay = started(["replay", "run/recording.mcap", ...view]);
  const played = await seen(replay, "replay", 2);
  stands(played, "recording of a port");
  has(played, "recording of a port", "/board/state", "/behavior");
  assert.equal(await replay.stop(), 0, replay.text);

  const bench = started(["bench", "motor", "--mcu", "native", "--filter", "step", "--pace", "1", "--out", "bench",
    "--view-wait", ...view]);
  const stand = await seen(bench, "bench", 2);
  has(stand, "bench", "/joint_states", "/board/state", "/tf");
  await bench.stop();

  const port = 20000 + process.pid % 20000;
  const evaluation = started(["evaluate", "track-ball", "--mcu", "native", "--set", "seconds=3", "--episodes", "2",
    "--jobs", "1", "--pace", "1", "--out", "evaluated", "--view-wait", "--view", `${port}`]);
  await evaluation.says(/watch it at/);
  // The first episode's process takes the port over.
  let episode;
  for (let i = 0; i < 20 && !episode?.has("/tf"); ++i) episode = await seen(evaluation, "evaluate", 1.5).catch(() => null);
  has(episode, "evaluate", "/tf", "/truth/joints", "/eyes/left", "/scene");
  await evaluation.stop();
  console.log("sim, run, monitor, replay, bench, evaluate: as they should be");
} finally {
  killAll();
}
