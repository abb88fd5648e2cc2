// The editor of poses: made by hand in the browser, saved, opened again, played here and by `kaz run play`.
// SPDX-License-Identifier: Apache-2.0
// node poses.mjs KAZ FOLDER [WIDTH HEIGHT]: a picture of the page goes to FOLDER. Exit status 77: there is no chromium.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync } from "node:fs";
import { launch, open } from "./browser.mjs";
import { killAll, messages, start } from "./testing.mjs";

// A small page is drawn faster: without a graphics card each picture takes its time.
const [kaz, folder, width = 780, height = 360] = process.argv.slice(2);
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
const degree = Math.PI / 180;
const browser = await launch();
const wrong = [];

// Of /truth/joints: the angle of each joint, rad, of each message.
const angles = (path) => messages(path).get("/truth/joints")
  .map(({ data }) => Array.from({ length: 18 }, (_, joint) => data.readDoubleLE(8 * joint)));
const NECK_PAN = 0, R_SH_PITCH = 6;  // shared/board/joints.def

try {
  const edited = `${folder}/edited`;
  const run = start(kaz, ["run", "pose", "--mcu", "native", "--out", edited, "--pace", "1", "--view", "127.0.0.1:0",
    "--view-open"]);
  const [, url] = await run.says(/watch the run at (\S+)/);

  // Without the token there is nothing to be set.
  const onlooker = (await open(browser, url.replace(/\?.*/, ""), wrong, { viewport: { width: 400, height: 300 } })).page;
  await onlooker.waitForFunction(() => document.getElementById("phase").textContent.startsWith("pose"));
  assert(await onlooker.isHidden("#poses"), "who has no token is offered the editor");
  await onlooker.close();

  const { page } = await open(browser, url, wrong, { viewport: { width: Number(width), height: Number(height) } });
  const slide = (joint, degrees) => page.locator(`#pose-of-${joint}`).fill(String(degrees));
  await page.waitForSelector("#pose-of-neck_pan");
  await page.click("#pose-keep");
  const turned = () => page.evaluate(() => window.kaz.pose("neck_pan"));
  const before = await turned();
  await slide("r_sh_pitch", -90);
  await slide("neck_pan", 30);
  await page.waitForFunction(() => document.querySelectorAll("#pose-list li").length === 1);
  // The robot follows: the neck's frame turns in the scene.
  for (let i = 0; i < 50 && Math.max(...(await turned()).map((x, k) => Math.abs(x - before[k]))) < 0.2; ++i)
    await page.waitForTimeout(100);
  assert(Math.max(...(await turned()).map((x, k) => Math.abs(x - before[k]))) >= 0.2, "the head does not turn");
  // The plot's newest target is where it was sent.
  await page.waitForFunction(() => Math.abs(window.kaz.target("neck_pan") - Math.PI / 6) < 1e-3);
  await page.click("#pose-keep");
  // By the keyboard: from 30 degrees two steps of half a degree up.
  await page.locator("#pose-of-neck_pan").focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => document.getElementById("pose-of-neck_pan").value === "31");
  await page.click("#pose-keep");
  await page.locator("#pose-list li:nth-child(3) input").fill("1.8");
  await page.locator("#pose-list li:nth-child(3) input").blur();
  await page.click("[aria-label='show pose 1']");
  await page.screenshot({ path: `${folder}/poses.png` });

  const download = page.waitForEvent("download");
  await page.click("#pose-save");
  await (await download).saveAs(`${folder}/poses.json`);
  const saved = JSON.parse(readFileSync(`${folder}/poses.json`, "utf8"));
  assert.deepEqual(saved.poses.map(({ time_s }) => time_s), [0, 1, 1.8]);
  const near = (a, b) => Math.abs(a - b) < 1e-4;
  assert(near(saved.poses[1].angles_rad.r_sh_pitch, -90 * degree));
  assert(near(saved.poses[1].angles_rad.neck_pan, 30 * degree));
  assert(near(saved.poses[2].angles_rad.neck_pan, 31 * degree), String(saved.poses[2].angles_rad.neck_pan));

  // Opened again it is the same; a file of something else is refused.
  await page.locator("#pose-open").setInputFiles({ name: "other.json", mimeType: "application/json",
    buffer: Buffer.from("{}") });
  await page.waitForFunction(() => document.getElementById("pose-note").textContent.includes("other.json"));
  for (const [poses, complaint] of [[[{ time_s: 0, angles_rad: { tail: 0 } }], "no joint is called tail"],
    [[{ time_s: 0, angles_rad: { neck_pan: 9 } }], "must be an angle from"], [[{ time_s: 0 }], "angles_rad"],
    [[{ time_s: 2, angles_rad: { neck_pan: 0 } }, { time_s: 1, angles_rad: { neck_pan: 0 } }], "greater"],
    [[null], "time_s"], [[], "at least one"]]) {
    await page.locator("#pose-open").setInputFiles({ name: "bad.json", mimeType: "application/json",
      buffer: Buffer.from(JSON.stringify({ format: "kaz-poses-1", poses })) });
    await page.waitForFunction((text) => document.getElementById("pose-note").textContent.includes(text), complaint);
    assert.equal(await page.locator("#pose-list li").count(), 3);
  }
  for (let i = 0; i < 3; ++i) await page.click("[aria-label='remove pose 1']");
  assert(await page.isDisabled("#pose-play"), "nothing can be played");
  await page.locator("#pose-open").setInputFiles(`${folder}/poses.json`);
  await page.waitForFunction(() => document.querySelectorAll("#pose-list li").length === 3);

  await page.click("#pose-play");
  await page.waitForFunction(() => document.getElementById("phase").textContent === "pose: play");
  await page.waitForFunction(() => document.getElementById("phase").textContent === "pose: hold");
  // The sliders, which stood at the first pose, go to what the motion left.
  await page.waitForFunction(() => document.querySelector("[for=pose-of-neck_pan] + input + output").textContent === "31.0°");
  await page.reload();
  await page.waitForFunction(() => document.querySelectorAll("#pose-list li").length === 3);
  await page.waitForSelector("#pose-of-neck_pan");
  await page.click("#pose-end");
  assert.equal(await run.ended, 0, run.text);
  assert.match(run.text, /1 motions played/);
  const shown = angles(`${edited}/recording.mcap`);
  assert(shown.some((at) => Math.abs(at[R_SH_PITCH] + 90 * degree) < 0.09), "the shoulder did not turn by 90 degrees");

  // It is recorded, and done again: the host alone, and the whole.
  for (const words of [[], ["--whole"]]) {
    const again = start(kaz, ["replay", ...words, edited]);
    assert.equal(await again.ended, 0, again.text);
    assert.match(again.text, /identical/);
  }

  // The file, by the verb.
  const played = start(kaz, ["run", "play", "--poses", `${folder}/poses.json`, "--mcu", "native", "--out", `${folder}/played`]);
  assert.equal(await played.ended, 0, played.text);
  const at = angles(`${folder}/played/recording.mcap`);
  const last = at.at(-1);
  assert(Math.abs(last[NECK_PAN] - 31 * degree) < 0.05, `the neck ends at ${last[NECK_PAN]} rad`);
  assert(Math.abs(last[R_SH_PITCH] + 90 * degree) < 0.09, `the shoulder ends at ${last[R_SH_PITCH]} rad`);
  assert.deepEqual(wrong.filter((text) => !text.includes("WebSocket connection")), [], "errors in the console");
  console.log("poses: made, saved, opened, played on the page and by kaz run play");
} finally {
  killAll();
  await browser.close();
}
