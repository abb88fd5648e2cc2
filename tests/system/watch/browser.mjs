// The page in headless Chromium.
// SPDX-License-Identifier: Apache-2.0
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";
import { kHang_ms } from "./testing.mjs";

// Ends the test with status 77 where there is no chromium.
export async function launch() {
  const executablePath = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find((path) => existsSync(path));
  if (!executablePath) {
    console.log("skipped: chromium is not installed (apt-get install chromium)");
    process.exit(77);
  }
  return chromium.launch({ executablePath, timeout: kHang_ms,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
}

// A page that shows the robot, and how long that took, ms. What its console complains of is added to `wrong`.
export async function open(browser, url, wrong, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1000, height: 600 }, ...options });
  page.setDefaultTimeout(kHang_ms);
  // 12 pictures per second: drawn by software, more of them would take most of the test's processor time. The page
  // lowers its quality at less than 11.
  await page.addInitScript(() => { window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 80); });
  page.on("console", (message) => {
    // The browser itself reports each attempt while the program is away.
    if (message.type() === "error" && !message.text().includes("ERR_CONNECTION_REFUSED")) wrong.push(message.text());
  });
  page.on("pageerror", (error) => wrong.push(String(error)));
  const before = Date.now();
  await page.goto(url);
  await page.waitForFunction(() => window.kaz?.frames() > 0 && window.kaz.pose("trunk"));
  return { page, took: Date.now() - before };
}
