// A film strip of a recording, as the page shows it: docs/pictures/film.jpg (./tools/dev pictures).
// SPDX-License-Identifier: Apache-2.0
// node film.mjs KAZ RECORDING FILE.jpg: six pictures, the last one at the end.
import { writeFileSync } from "node:fs";
import { launch, open } from "./browser.mjs";
import { killAll, start } from "./testing.mjs";

const [kaz, recording, file] = process.argv.slice(2);
const shares = [0.02, 0.25, 0.5, 0.7, 0.85, 1];
const columns = 3, width = 420, height = 380;
const browser = await launch();
try {
  const player = start(kaz, ["replay", recording, "--view", "127.0.0.1:0"]);
  const [, url] = await player.says(/watch it at (\S+)/);
  const wrong = [];
  const { page } = await open(browser, url, wrong, { viewport: { width: width + 350, height: height + 78 } });  // header and player
  await page.uncheck("#frusta");
  await page.click("#play");
  await page.waitForFunction(() => !window.kaz.playing());
  const pictures = [];
  for (const share of shares) {
    await page.locator("#scrub").fill(String(Math.round(1000 * share)));
    await page.waitForTimeout(2500);  // the camera follows the robot by and by
    const data = await page.locator("#view").screenshot({ type: "png" });
    pictures.push({ url: `data:image/png;base64,${data.toString("base64")}`, text: await page.textContent("#time") });
  }
  const strip = await page.evaluate(async ({ pictures, columns, width, height }) => {
    const canvas = document.createElement("canvas");
    canvas.width = columns * width;
    canvas.height = Math.ceil(pictures.length / columns) * height;
    const context = canvas.getContext("2d");
    for (const [i, { url, text }] of pictures.entries()) {
      const image = new Image();
      image.src = url;
      await image.decode();
      const x = i % columns * width, y = Math.floor(i / columns) * height;
      context.drawImage(image, x, y, width, height);
      context.font = "bold 18px sans-serif";
      context.fillStyle = "#fff";
      context.strokeStyle = "#0008";
      context.lineWidth = 4;
      context.strokeText(text, x + 10, y + 26);
      context.fillText(text, x + 10, y + 26);
    }
    return canvas.toDataURL("image/jpeg", 0.85);
  }, { pictures, columns, width, height });
  writeFileSync(file, Buffer.from(strip.slice(strip.indexOf(",") + 1), "base64"));
  await player.stop();
} finally {
  killAll();
  await browser.close();
}
