// The same script on the native board, with each engine, and on emscripten's: the same text.
// SPDX-License-Identifier: Apache-2.0
// node states.mjs BOARD_SCRIPT IMAGE PAGE SCRIPT
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";

const [native, image, page, path] = process.argv.slice(2);
const script = readFileSync(path, "utf8");
function run(program, words) {
  const done = spawnSync(program, [...words, script], { encoding: "utf8", maxBuffer: 1 << 26 });
  assert.equal(done.status, 0, `${program} ${words.join(" ")}: ${done.error ?? done.stderr}`);
  return done.stdout.trimEnd().split("\n");
}
for (const noise of [[], ["--no-noise"]]) {
  const wasm = run(process.execPath, [`${page}/board_script.js`, ...noise]);
  for (const engine of ["translator", "interpreter"]) {
    const here = run(native, ["--image", image, "--engine", engine, ...noise]);
    here.forEach((line, i) => assert.equal(wasm[i], line, `line ${i + 1}, ${engine} ${noise}`));
    assert.equal(wasm.length, here.length);
  }
  const states = wasm.filter((line) => line.startsWith("at "));
  const frames = wasm.filter((line) => line.startsWith("in "));
  assert(Number(states.at(-1).split(" ")[1]) > 18432000, "less than a second of the board");
  assert(frames.length > 50, `only ${frames.length} frames came from the board`);
  // The script does what it says: the joint is turned, motors go off and come back, something is refused.
  assert(new Set(states.map((line) => line.split(" ").at(-1))).size > 8, "nothing moved");
  assert(frames.some((line) => / 00..01ff/.test(line)), "nothing was refused");
  console.log(`${noise[0] ?? "with noise"}: ${states.length} states, ${frames.length} frames from the board, equal`);
}
