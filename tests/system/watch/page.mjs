// The page of --view in a real browser: live, played, with two viewers, after a restart.
// SPDX-License-Identifier: Apache-2.0
// node page.mjs KAZ FOLDER: pictures of the page go to FOLDER. Exit status 77: there is no chromium.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdirSync, readdirSync, readFileSync } from "node:fs";
import { launch, open as openIn } from "./browser.mjs";
import { killAll, start, until } from "./testing.mjs";

const [kaz, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });

const started = (...words) => {
  const program = start(kaz, words);
  return Object.assign(program, { url: program.says(/watch the run at (\S+)/).then(([, url]) => url) });
};
const run = (port, ...more) => started("run", "track-ball", "--mcu", "native", "--set", "seconds=600", "--pace", "1",
  "--modules", "color,depth",
  ...more, "--view", `127.0.0.1:${port}`);

const browser = await launch();
const wrong = [];
let lapStart = Date.now();
function lap(what) {
  console.log(`${what}: ${Date.now() - lapStart} ms`);
  lapStart = Date.now();
}
const open = (url, options) => openIn(browser, url, wrong, options);
// CPU time of the server's thread, s.
function serverTime(pid) {
  for (const task of readdirSync(`/proc/${pid}/task`)) {
    const stat = readFileSync(`/proc/${pid}/task/${task}/stat`, "utf8");
    const [, name, rest] = /\((.*)\) (.*)/.exec(stat);
    if (name === "view") return (Number(rest.split(" ")[11]) + Number(rest.split(" ")[12])) / 100;
  }
  throw new Error("the server has no thread");
}
const head = (page) => page.evaluate(() => window.kaz.pose("neck_tilt"));
const differ = (a, b) => Math.max(...a.map((x, i) => Math.abs(x - b[i])));

try {
  // Live.
  const recorded = `${folder}/run`;
  const live = run(0, "--out", recorded);
  const url = await live.url;
  const { page, took } = await open(url);
  console.log(`the page shows the robot ${took} ms after it was opened`);
  await page.waitForFunction(() => window.kaz.pictures() > 4 && window.kaz.plotted() > 30);
  const pixels = () => page.evaluate(() => document.getElementById("view").toDataURL());
  const [a, shot] = [await head(page), await pixels()];
  await until(async () => differ(a, await head(page)) >= 0.01, "the head moves in the scene");
  assert(shot.length > 5000, "the picture of the robot is empty");
  // The scene has moved; the picture is drawn by software, and may come some frames later.
  await until(async () => shot !== await pixels(), "the picture of the robot changes");
  const [cpu, begun, shown] = [serverTime(live.child.pid), Date.now(), await page.evaluate(() => window.kaz.plotted())];
  await page.waitForTimeout(3000);
  const share = 100 * (serverTime(live.child.pid) - cpu) / ((Date.now() - begun) / 1000);
  console.log(`the server takes ${share.toFixed(1)} % of a core with one viewer`);
  assert(share < 10, `the server takes ${share} % of a core`);
  assert(await page.evaluate(() => window.kaz.plotted()) > shown, "no state of the board came in that time");
  const trunk = await page.evaluate(() => window.kaz.pose("trunk"));
  assert(trunk[2] > 0.1 && trunk[2] < 0.2, `the trunk is at a height of ${trunk[2]} m`);
  // 0 for the moment in which the next one is being decoded.
  await page.waitForFunction(() => document.getElementById("left").naturalWidth >= 320);
  assert.match(await page.textContent("#phase"), /track-ball/);
  assert.equal(await page.textContent("#connection"), "live");
  // What vision makes of it: the ball is marked, and depth is shown once it is chosen.
  await page.waitForFunction(() => !document.getElementById("ball-mark").hidden);
  await page.selectOption("#module", "/vision/depth");
  await page.waitForFunction(() => document.getElementById("made").naturalWidth >= 300);
  lap("live");
  await page.screenshot({ path: `${folder}/light.jpg`, quality: 85 });
  await page.click("#theme");
  await page.waitForTimeout(200);
  await page.screenshot({ path: `${folder}/dark.png` });

  lap("pictures");
  // A second viewer, in a narrow window: nothing is wider than it.
  const second = await open(url, { viewport: { width: 390, height: 844 } });
  const wide = await second.page.evaluate(() => document.documentElement.scrollWidth);
  assert(wide <= 390, `the page is ${wide} px wide in a window of 390`);
  await second.page.waitForFunction(() => window.kaz.pictures() > 1);
  await second.page.screenshot({ path: `${folder}/narrow.png`, fullPage: true });
  await second.page.close();

  lap("second viewer");
  // By hand: the ball is dragged, the run pauses and goes on, a fault begins and the board states what it did.
  await page.waitForFunction(() => !document.getElementById("hands").hidden && window.kaz.pose("ball/ball"));
  await page.uncheck("#follow");
  const ballAt = () => page.evaluate(() => window.kaz.pose("ball/ball"));
  const canvas = await page.locator("#view").boundingBox();
  // What was under way arrives, which takes its time where the browser is behind; then the run's time stands still.
  const pause = async () => {
    await page.click("#pause");
    let stopped = -1;
    for (let i = 0, same = 0; i < 80 && same < 6; ++i) {
      const now = await page.evaluate(() => window.kaz.time());
      same = now === stopped ? same + 1 : 0;
      stopped = now;
      await page.waitForTimeout(500);
    }
    await page.waitForTimeout(500);
    return stopped;
  };
  // It rolls about: it is taken while the run pauses, from as far away as shows it.
  await pause();
  // Who opens the page meanwhile is shown the robot where it stands, and that the run pauses.
  const late = await open(url);
  await late.page.waitForFunction(() => window.kaz.pose("trunk")?.[2] > 0.1 && window.kaz.pose("ball/ball")?.[0] !== 0
    && document.getElementById("pause").textContent === "resume" && document.getElementById("pace").value === "1",);
  await late.page.close();
  await page.mouse.move(canvas.x + canvas.width / 2, canvas.y + canvas.height / 2);
  let at;
  for (let i = 0; i < 30; ++i) {
    at = await page.evaluate(() => window.kaz.onCanvas("ball/ball"));
    if (at && at[0] >= 20 && at[1] >= 100 && at[0] <= canvas.width - 20 && at[1] <= canvas.height - 20) break;
    await page.mouse.wheel(0, 200);
    await page.waitForTimeout(200);
  }
  assert(at, "the ball is behind the camera");
  // Beside its middle: what is missed by a few pixels is taken, too.
  await page.mouse.move(canvas.x + at[0] + 12, canvas.y + at[1]);
  await page.mouse.down();
  await page.evaluate(() => document.getElementById("pause").click());
  await page.mouse.move(canvas.x + at[0], canvas.y + at[1] - 40, { steps: 5 });
  await page.mouse.move(canvas.x + at[0], canvas.y + at[1] - 80, { steps: 5 });
  await page.waitForFunction(() => window.kaz.pose("ball/ball")?.[2] > 0.06);
  await page.screenshot({ path: `${folder}/held.png` });
  await page.mouse.up();
  await page.waitForFunction(() => window.kaz.pose("ball/ball")?.[2] < 0.05);
  const stopped = await pause();
  assert.equal(await page.evaluate(() => window.kaz.time()), stopped, "the run does not pause");
  await page.click("#step");
  await page.waitForFunction((before) => window.kaz.time() > before + 0.05, stopped);
  await page.click("#pause");
  await page.waitForFunction((before) => window.kaz.time() > before + 0.5, stopped);
  assert.equal(await page.textContent("#shutdown"), "no");
  await page.selectOption("#fault-name", "pot_open");
  await page.selectOption("#fault-joint", "neck_tilt");
  await page.click("#fault-form button[type=submit]");
  await page.waitForFunction(() => document.getElementById("fault").textContent.includes("pot_open"));
  await page.waitForFunction(() => document.getElementById("shutdown").textContent !== "no");
  console.log(`the board: ${await page.textContent("#shutdown")}; the ball is at ${await ballAt()}`);

  lap("by hand");
  // The program ends and comes back at the same port.
  const port = new URL(url).port;
  await live.stop();
  const again_by_hand = spawnSync(kaz, ["replay", `${recorded}/recording.mcap`], { encoding: "utf8" });
  assert.equal(again_by_hand.status, 0, `done again, it is another run: ${again_by_hand.stdout}${again_by_hand.stderr}`);
  await page.waitForFunction(() => document.getElementById("connection").textContent.startsWith("not connected"));
  const again = run(port);
  await again.url;
  // Its token is new: the page says which address to open.
  const connection = (page, text) => page.waitForFunction(
    (part) => document.getElementById("connection").textContent.includes(part), text);
  await connection(page, "this address has another run's token");
  await page.goto(await again.url);
  await connection(page, "live");
  await page.goto((await again.url).replace(/\?.*/, ""));
  await connection(page, "this address has no token");
  assert(await page.isHidden("#hands"), "without the token there is something to do by hand");
  await again.stop();
  // With --view-open one may look without the token, and connects again by oneself.
  const open_run = run(port, "--view-open");
  await connection(page, "live");
  await page.waitForFunction(() => window.kaz?.frames() > 0 && window.kaz.pose("trunk"));
  await page.waitForFunction(() => document.getElementById("locked").textContent.includes("with its token to control"));
  assert(await page.isVisible("#locked") && await page.isHidden("#hands"), "without the token one may act");
  await open_run.url;
  await open_run.stop();
  await page.close();

  lap("restart");
  // Played: pause, jump, keys.
  const played = started("replay", `${recorded}/recording.mcap`, "--view", "127.0.0.1:0");
  const player = (await open(await played.url)).page;
  const time = () => player.evaluate(() => window.kaz.time());
  await player.click("#play");
  await player.waitForFunction(() => !window.kaz.playing());
  const paused = await time();
  await player.waitForTimeout(400);
  assert.equal(await time(), paused);
  // Far from where the player happens to pause on a busy machine.
  const place = Number(await player.locator("#scrub").inputValue());
  await player.locator("#scrub").fill(place < 500 ? "800" : "300");
  await player.waitForFunction((before) => Math.abs(window.kaz.time() - before) > 0.3, paused);
  const middle = await time();
  await player.locator("#view").focus();
  await player.keyboard.press(",");
  await player.waitForFunction((before) => window.kaz.time() < before - 0.5, middle);
  await player.keyboard.press(" ");
  await player.waitForFunction(() => window.kaz.playing());
  await player.waitForFunction((before) => window.kaz.time() > before, middle);
  await player.screenshot({ path: `${folder}/player.png` });
  assert.equal(await played.stop(), 0, "the player's exit status");
  assert.deepEqual(wrong.filter((text) => !text.includes("WebSocket connection")), [], "errors in the console");
  lap("player");
  console.log("live, two viewers, restart and player: as they should be");
} finally {
  killAll();
  await browser.close();
}
