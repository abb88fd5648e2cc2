// The page plays a recording: what its scene looks like.
// SPDX-License-Identifier: Apache-2.0
// node recording.mjs KAZ FOLDER: pictures of the page go to FOLDER. Exit status 77: there is no chromium.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { launch, open } from "./browser.mjs";
import { killAll, start } from "./testing.mjs";

const [kaz, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const browser = await launch();
const wrong = [];

// Brightness of the scene around a place in the world: mean and standard deviation, 0 to 255.
const brightness = (page, place) => page.evaluate((place) => {
  const view = document.getElementById("view");
  const [x, y] = window.kaz.onCanvas(place).map((px) => Math.round(px * view.width / view.clientWidth));
  const copy = document.createElement("canvas");
  copy.width = copy.height = 12;
  const context = copy.getContext("2d");
  context.drawImage(view, x - 6, y - 6, 12, 12, 0, 0, 12, 12);
  const pixels = context.getImageData(0, 0, 12, 12).data;
  const values = Array.from({ length: 144 }, (_, i) => (pixels[4 * i] + pixels[4 * i + 1] + pixels[4 * i + 2]) / 3);
  const mean = values.reduce((sum, value) => sum + value) / 144;
  return { mean, deviation: Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / 144) };
}, place);

async function played(words) {
  const player = start(kaz, ["replay", "--view", "127.0.0.1:0", ...words], folder);
  const [, url] = await player.says(/watch it at (\S+)/);
  return { player, page: (await open(browser, url, wrong)).page };
}

try {
  const run = start(kaz, ["run", "search-ball", "--out", "seen"], folder);
  assert.equal(await run.ended, 0, run.text);
  const { player, page } = await played(["seen"]);

  // The floor has the renderer's pattern: without it the deviation was 0.0, with it 4.7 and 3.8.
  let least = 0;
  for (let i = 0; i < 50 && least < 1; ++i) {
    const patches = [await brightness(page, [0.3, -0.3, 0]), await brightness(page, [-0.5, -0.2, 0])];
    least = Math.min(...patches.map(({ deviation }) => deviation));
    await page.waitForTimeout(100);
  }
  await page.screenshot({ path: `${folder}/floor.png` });
  console.log(`brightness of the floor: standard deviation ${least.toFixed(1)}`);
  assert(least >= 1, `the floor has no pattern: the standard deviation of its brightness is ${least}`);

  assert.equal(await player.stop(), 0, "the player's exit status");
  assert.deepEqual(wrong, [], "errors in the console");
} finally {
  killAll();
  await browser.close();
}
