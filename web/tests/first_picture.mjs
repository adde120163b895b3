// How long a reader waits for the first useful picture of each page: node first_picture.mjs [TIMES]. Each time a new browser
// context, without anything cached. "works": how long the thread of the page computes for it, which other programs do not change.
// HYDROSCOPE names the program, CHROMIUM the browser.

import { fileURLToPath } from "node:url";
import { makeHistory } from "./history.mjs";
import { browser, folder, open, run } from "./program.mjs";

const times = Number(process.argv[2] ?? 9);
const machine = fileURLToPath(new URL("../../machines/die_cushion.toml", import.meta.url));
const place = folder();
run(["simulate", "press", "--out", "leak.csv", "--seconds", "90", "--seed", "4", "--effect", "internal_leakage=4e-12"], place.path);
makeHistory(place.path);
const chromium = await browser();

/** ms from asking for the page until `there` shows, and of these the page computed. */
async function wait(address, there) {
  const context = await chromium.newContext({ viewport: { width: 1400, height: 900 } });
  const page = await context.newPage();
  const devTools = await context.newCDPSession(page);
  await devTools.send("Performance.enable", { timeDomain: "threadTicks" });
  const begin = performance.now();
  await page.goto(address, { waitUntil: "commit" });
  await page.waitForSelector(there);
  const waited = performance.now() - begin;
  const { metrics } = await devTools.send("Performance.getMetrics");
  await context.close();
  return [waited, 1000 * metrics.find(({ name }) => name === "TaskDuration").value];
}

console.log("page                                   least ms    median   most     works");
async function measure(name, address, there) {
  const all = [];
  for (let k = 0; k < times; ++k) all.push(await wait(address, there));
  const [waited, works] = [0, 1].map((which) => all.map((one) => one[which]).sort((a, b) => a - b)), half = Math.floor(times / 2);
  console.log(`${name.padEnd(38)} ${[waited[0], waited[half], waited[times - 1], works[half]].map((ms) => ms.toFixed(0).padStart(8)).join(" ")}`);
}

const first = await open([], place.path);
await measure("drop a log", first.address, ".drop");
await first.stop();
const work = await open(["leak.csv", "--machine", machine], place.path);
await wait(`${work.address}#step=compare`, ".centre .plot canvas");  // worked out, as it is for all but the first
await measure("workbench, a stroke drawn", `${work.address}#step=compare`, ".centre .plot canvas");
await work.stop();
const watched = await open(["--db", "press.db", "--machine", "press.toml"], place.path);
await measure("overview, parameters of an axis", watched.address, ".tile tbody tr");
await measure("trend", `${watched.address}#view=trends&p=K`, ".trend-plot canvas");
await measure("alarms", `${watched.address}#view=alarms`, ".alarm-table");
await watched.stop();
await chromium.close();
place.remove();
