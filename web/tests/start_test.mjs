// What may come in another order than usual when a page begins. node --test start_test.mjs. HYDROSCOPE names the program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { endBrowser, startBrowser, visitIn } from "./browser_fixture.mjs";
import { folder, open, run } from "./program.mjs";

const machine = fileURLToPath(new URL("../../machines/die_cushion.toml", import.meta.url));
const place = folder();

before(async () => {
  await startBrowser();
  run(["simulate", "press", "--out", "leak.csv", "--seconds", "40", "--effect", "internal_leakage=4e-12"], place.path);
});
after(async () => {
  await endBrowser();
  place.remove();
});

/** Drawing waits for frames; none comes for a second. */
const withoutFrames = () => {
  const later = window.setTimeout;
  window.requestAnimationFrame = (then) => later(() => then(performance.now()), 1000);
  window.setTimeout = (then, ms, ...more) => later(then, Math.max(ms ?? 0, 1000), ...more);
};

test("a session that is there before the page listens is drawn", async (t) => {
  const { page, address } = await visitIn(place.path, t, []);
  await page.addInitScript(withoutFrames);
  await page.goto(address);
  await page.waitForSelector(".drop", { timeout: 30_000 });
});

test("work that ended before its events are heard is seen", async (t) => {
  const { page, address } = await visitIn(place.path, t, ["leak.csv", "--machine", machine]);
  await page.route("**/api/v1/events", async (route) => {
    while (!(await fetch(`${address}api/v1/results?kind=compare`)).ok) await new Promise((go) => setTimeout(go, 100));
    await route.continue();
  });
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector(".centre .plot canvas", { timeout: 60_000 });
});

test("a program that begins anew at the same port works everything out anew, and the page shows it", async (t) => {
  const words = ["leak.csv", "--machine", machine];
  const { page, address, served } = await visitIn(place.path, t, words);
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector("[data-verdict]");
  await served.stop();
  await page.waitForSelector(".lost");
  const again = await open([...words, "--port", new URL(address).port], place.path);
  t.after(() => again.stop());
  await page.waitForSelector(".lost", { state: "detached" });
  await page.waitForSelector(".scrubber");
  await page.waitForSelector("[data-verdict]");
});

test("a second Ctrl-C ends it at once, though work is under way", async (t) => {
  run(["simulate", "pump", "--out", "pump.csv"], place.path);
  const pump = fileURLToPath(new URL("../../machines/pump.toml", import.meta.url));
  const { page, address, served } = await visitIn(place.path, t, ["pump.csv", "--machine", pump]);
  await page.goto(`${address}#step=check`);
  await page.waitForSelector(".stepper");
  const ended = served.stop(), after = (ms) => new Promise((go) => setTimeout(go, ms, "works on"));
  assert.equal(await Promise.race([ended, after(2000)]), "works on");  // a pump is explained in ten seconds
  process.kill(served.pid, "SIGINT");
  assert.equal(await Promise.race([ended, after(2000)]), 0);
});
