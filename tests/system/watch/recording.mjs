// The page plays a recording: what its scene looks like.
// SPDX-License-Identifier: Apache-2.0
// node recording.mjs KAZ FOLDER: pictures of the page go to FOLDER. Exit status 77: there is no chromium.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync } from "node:fs";
import { launch, open } from "./browser.mjs";
import { killAll, start, until } from "./testing.mjs";

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
  const [, url] = await player.says(/watch the run at (\S+)/);
  return { player, page: (await open(browser, url, wrong)).page };
}

try {
  const run = start(kaz, ["run", "search-ball", "--out", "seen"], folder);
  assert.equal(await run.ended, 0, run.text);
  const { player, page } = await played(["seen"]);

  // Until data arrive the page says that it is loading: here its socket never opens.
  assert(await page.isHidden("#loading"), "it says that it is loading, and shows the robot");
  const url = page.url();
  const waiting = await browser.newPage();
  await waiting.addInitScript(() => { window.WebSocket = class { close() {} }; });
  await waiting.goto(url);
  for (const id of ["#loading", "#no-eyes", "#joints-chosen", "#no-board"])
    assert.equal(await waiting.textContent(id), "loading…", id);
  assert(await waiting.isVisible("#loading") && await waiting.isHidden("#board"), "an empty page without a word");
  await waiting.screenshot({ path: `${folder}/loading.png` });
  await waiting.close();
  // Without the token the reason stands in the same place.
  const stranger = await browser.newPage();
  await stranger.goto(url.replace(/\?.*/, ""));
  await stranger.waitForFunction(() => document.getElementById("loading").textContent.includes("no token"));
  assert(await stranger.isVisible("#loading"));
  await stranger.close();

  // Without pictures the page says so, and how to record some.
  await page.waitForFunction(() => document.getElementById("no-eyes").textContent.includes("contains no pictures"));
  assert.match(await page.textContent("#no-eyes"), /kaz run search-ball --world ball --eyes ideal --seed 1 --out DIR --record-pictures$/);

  // The floor has the renderer's pattern: without it the deviation was 0.0, with it 4.7 and 3.8.
  await until(async () => {
    const patches = [await brightness(page, [0.3, -0.3, 0]), await brightness(page, [-0.5, -0.2, 0])];
    return Math.min(...patches.map(({ deviation }) => deviation)) >= 1;
  }, "the floor has a pattern: the standard deviation of its brightness is at least 1");
  await page.screenshot({ path: `${folder}/floor.png` });

  // The robot's shadow lies on the side away from the sun, where the camera looks only once it is turned.
  await page.uncheck("#frusta");
  const view = await page.locator("#view").boundingBox();
  await page.mouse.move(view.x + 20, view.y + 40);
  await page.mouse.down();
  await page.mouse.move(view.x + 20 + view.height / 4, view.y + 40, { steps: 5 });
  await page.mouse.up();
  const [x, y] = await page.evaluate(() => window.kaz.pose("trunk"));
  const across = { x: 0.14, y: -0.127 };  // m, toward the sun; measured: 35 %, without shadows -5 %
  await until(async () => {
    const [lit, shaded] = [await brightness(page, [x + across.x, y + across.y, 0]),
      await brightness(page, [x - across.x, y - across.y, 0])];
    return 1 - shaded.mean / lit.mean >= 0.2;
  }, "the floor in the robot's shadow is darker by at least 20 %");
  await page.screenshot({ path: `${folder}/shadow.png` });

  // From the beginning again, wherever the player is.
  await page.waitForFunction(() => window.kaz.time() > 2.5);
  await page.selectOption("#speed", "0.1");
  await page.click("#restart");
  await page.waitForFunction(() => window.kaz.playing() && window.kaz.time() < 1);

  // A jump sends robot and objects again: they replace those before.
  const meshes = await page.evaluate(() => window.kaz.meshes());
  for (let i = 0; i < 3; ++i) {
    await page.click("#restart");
    await page.waitForTimeout(1000);
  }
  await page.waitForFunction((before) => window.kaz.meshes() === before, meshes);

  // The 3D view as a PNG file.
  const saved = async (page, button, width, height) => {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
    const png = readFileSync(await download.path());
    assert.equal(png.toString("latin1", 1, 4), "PNG");
    assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [width, height], `${button}: the size`);
    assert(png.length > 10000, `${button}: the file is empty`);
    return download.suggestedFilename();
  };
  const name = await saved(page, "#save-view", Math.round(view.width), Math.round(view.height));
  assert.match(name, /^kaz-view-\d+\.\d\ds\.png$/);
  assert(await page.isHidden("#save-eyes"), "there is nothing to save of the eyes");

  // Several joints in one plot, each with its color; at most six, and one stays.
  const box = (joint) => page.locator("#joint-list label", { hasText: new RegExp(`^ ${joint}$`) }).locator("input");
  await page.click("#joints summary");
  assert(await box("neck_pan").isChecked() && await box("neck_pan").isDisabled(), "the last joint can be taken away");
  await box("neck_tilt").check();
  assert.deepEqual(await page.locator("#joints-chosen span").allTextContents(), ["neck_pan", "neck_tilt"]);
  await page.selectOption("#speed", "1");
  // Pixels of about the color of the second joint, #e69f00. A browser that is far behind misses states: then again.
  const second = () => page.evaluate(() => {
    const plot = document.getElementById("plot");
    const { data } = plot.getContext("2d").getImageData(0, 0, plot.width, plot.height);
    let found = 0;
    for (let i = 0; i < data.length; i += 4)
      found += data[i] > 0xd0 && Math.abs(data[i + 1] - 0x9f) < 20 && data[i + 2] < 40 && data[i + 3] > 100;
    return found;
  });
  await until(async () => {
    await page.click("#restart");
    for (let i = 0; i < 5 && await second() <= 20; ++i) await page.waitForTimeout(1000);
    return await second() > 20;
  }, "the plot has a second joint");
  for (let i = 0; i < 4; ++i) await page.locator("#joint-list input:enabled:not(:checked)").first().check();
  assert.equal(await page.locator("#joint-list input:enabled:not(:checked)").count(), 0, "a seventh joint can be added");
  await page.screenshot({ path: `${folder}/joints.png` });

  assert.equal(await player.stop(), 0, "the player's exit status");
  await page.waitForFunction(() => document.getElementById("connection").textContent.includes("the program has ended"));

  // The command that it names has the pictures: both are shown in place of the text.
  const again = start(kaz, ["run", "search-ball", "--seed", "1", "--out", "pictures", "--record-pictures"], folder);
  assert.equal(await again.ended, 0, again.text);
  const other = await played(["pictures"]);
  // A browser that is far behind misses pictures of a recording of 3 s, and the last one is not sent again.
  const seen = () => other.page.evaluate(() => document.getElementById("left").naturalWidth >= 320
    && document.getElementById("right").naturalWidth >= 320 && document.getElementById("no-eyes").hidden);
  // While an element loads its next picture, its width is 0.
  let both = await seen();
  for (let i = 0; i < 1000 && !both; ++i) {
    if (i % 100 === 99) await other.page.click("#restart");
    await other.page.waitForTimeout(100);
    both = await seen();
  }
  assert(both, "no pictures of the eyes");
  assert.match(await saved(other.page, "#save-eyes", 640, 240), /^kaz-eyes-/);
  await other.player.stop();
  assert.deepEqual(wrong, [], "errors in the console");
} finally {
  killAll();
  await browser.close();
}
