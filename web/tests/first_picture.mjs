// How long a reader waits for the first useful picture of each page: node first_picture.mjs [TIMES]. Each time a new browser
// context, without anything cached. HYDROSCOPE names the program, CHROMIUM the browser.

import { fileURLToPath } from "node:url";
import { makeHistory } from "./history.mjs";
import { browser, folder, open, run } from "./program.mjs";

const times = Number(process.argv[2] ?? 9);
const machine = fileURLToPath(new URL("../../machines/die_cushion.toml", import.meta.url));
const place = folder();
run(["simulate", "press", "--out", "leak.csv", "--seconds", "90", "--seed", "4", "--effect", "internal_leakage=4e-12"], place.path);
makeHistory(place.path);
const chromium = await browser();

/** ms from asking for the page until `there` shows. */
async function wait(address, there) {
  const context = await chromium.newContext({ viewport: { width: 1400, height: 900 } });
  const page = await context.newPage();
  const begin = performance.now();
  await page.goto(address, { waitUntil: "commit" });
  await page.waitForSelector(there);
  const waited = performance.now() - begin;
  await context.close();
  return waited;
}

console.log("page                                   median ms   most ms");
async function measure(name, address, there) {
  const waited = [];
  for (let k = 0; k < times; ++k) waited.push(await wait(address, there));
  waited.sort((a, b) => a - b);
  console.log(`${name.padEnd(38)} ${waited[Math.floor(times / 2)].toFixed(0).padStart(9)} ${waited[times - 1].toFixed(0).padStart(9)}`);
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
