// How a trend of very many strokes pans in a real browser: node long_trend.mjs [STROKES [FOLDER]], 10 000 000 without a number. The
// database is made with sqlite3 (some 200 bytes a stroke) in a folder that is removed at the end; in a FOLDER that is given it stays
// and is used again. HYDROSCOPE names the program, CHROMIUM the browser.

import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { browser, folder, open, run } from "./program.mjs";

const strokes = Number(process.argv[2] ?? 10_000_000), patience = 1_800_000;
const machine = fileURLToPath(new URL("../../machines/die_cushion.toml", import.meta.url));
const place = process.argv[3] ? { path: process.argv[3], remove: () => {} } : folder();
mkdirSync(place.path, { recursive: true });

/** One run of many strokes behind those of a log: a stroke every 12 s, K follows the oil, with a spike now and then. */
function makeLongTrend() {
  run(["simulate", "press", "--out", "press.csv", "--seconds", "60"], place.path);
  run(["replay", "press.csv", "--machine", machine, "--db", "long.db"], place.path);
  rmSync(join(place.path, "long.alarms.db"), { force: true });  // nothing is judged here
  const columns = (table) => spawnSync("sqlite3", ["long.db", `SELECT group_concat(name) FROM pragma_table_info('${table}')`], { cwd: place.path, encoding: "utf8" }).stdout.trim().split(",");
  const values = { run: "2", stroke: "k", begin_s: "1.6e9 + 12.0 * k", end_s: "1.6e9 + 12.0 * k + 1.5", oil_temperature_K: "313 + 8 * sin(k / 1200.0)" };
  const copied = columns("stroke").map((name) => values[name] ?? name).join();
  const long = { id: "2", source: "'long'", fingerprint: "'long'", first_sequence: "first_sequence + strokes", strokes, state: "'complete'" };
  const run2 = columns("run").map((name) => long[name] ?? name).join();
  const done = spawnSync("sqlite3", ["long.db", `
    PRAGMA journal_mode = MEMORY; PRAGMA synchronous = OFF;
    INSERT INTO run SELECT ${run2} FROM run WHERE id = 1;
    CREATE TEMP TABLE one AS SELECT * FROM stroke WHERE run = 1 LIMIT 1;
    INSERT INTO stroke WITH RECURSIVE n(k) AS (SELECT 0 UNION ALL SELECT k + 1 FROM n WHERE k < ${strokes} - 1) SELECT ${copied} FROM n, one;
    INSERT INTO estimate(parameter, run, stroke, value, std, excitation, last_excited_s, reason) WITH RECURSIVE n(k) AS (SELECT 0 UNION ALL SELECT k + 1 FROM n WHERE k < ${strokes} - 1)
      SELECT (SELECT id FROM parameter WHERE name = 'K'), 2, k, 1.2e9 + 2e7 * sin(k / 1200.0) - 3.0 * k + (k % 99991 = 7) * 5e7, 2e6, 0.5, 1.6e9 + 12.0 * k, 'updated' FROM n;
    PRAGMA journal_mode = WAL;`], { cwd: place.path, encoding: "utf8" });
  if (done.status !== 0 || done.stderr) throw new Error(`sqlite3: ${done.stderr}`);
}

/** Pans for some seconds, a turn of the wheel with every frame, so many pixels each, back after so many frames; how long the frames took. Without pixels: frames of the browser alone. */
function panFor({ seconds, pixels, back }) {
  const box = document.querySelector(".trend-plot [role=application]"), over = document.querySelector(".trend-plot .u-over").getBoundingClientRect();
  const event = () => new WheelEvent("wheel", { shiftKey: true, deltaY: turn, bubbles: true, cancelable: true, clientX: over.left + over.width / 2, clientY: over.top + 20 });
  let turn = pixels;
  return new Promise((resolve) => {
    const frames = [];
    let before = performance.now();
    const begin = before;
    const frame = (now) => {
      frames.push(now - before);
      before = now;
      if (frames.length % back === 0) turn = -turn;
      if (pixels !== 0) box.dispatchEvent(event());
      if (now - begin < 1000 * seconds) requestAnimationFrame(frame); else resolve(frames.slice(2));
    };
    requestAnimationFrame(frame);
  });
}

const at = (list, share) => [...list].sort((a, b) => a - b)[Math.floor(share * (list.length - 1))].toFixed(1);
const seconds = 5, onAndOn = 1e9;
const told = (frames) => `${(1000 * frames.length / frames.reduce((sum, frame) => sum + frame, 0)).toFixed(1)} frames a second, ${at(frames, 0.5)} ms in the median, ${at(frames, 0.99)} ms at p99, ${at(frames, 1)} ms at most`;
const begun = Date.now();
if (!existsSync(join(place.path, "long.db"))) {
  makeLongTrend();
  console.log(`${strokes} strokes stored in ${((Date.now() - begun) / 1000).toFixed(0)} s`);
}
const forgotten = spawnSync("dd", [`of=${join(place.path, "long.db")}`, "oflag=nocache", "conv=notrunc,fdatasync", "count=0", "status=none"]);  // by the memory, not the disk
if (forgotten.status !== 0) throw new Error(`dd: ${forgotten.stderr}`);
const served = await open(["--db", "long.db"], place.path);
const chromium = await browser();
const page = await (await chromium.newContext({ viewport: { width: 1400, height: 900 } })).newPage();
page.setDefaultTimeout(patience);
const devTools = await page.context().newCDPSession(page);
await devTools.send("Performance.enable", { timeDomain: "threadTicks" });
const worked = async () => 1000 * (await devTools.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
/** How it pans, and how long the thread of the page computes for a frame, which other programs do not change. */
async function panned(way) {
  const before = await worked(), frames = await page.evaluate(panFor, way);
  return `${told(frames)}; ${((await worked() - before) / frames.length).toFixed(1)} ms of work each`;
}
let start = Date.now(), answered;
page.on("requestfinished", (request) => { if (/watch\/trend/.test(request.url())) answered ??= request.timing().responseEnd; });
await page.goto(`${served.address}#view=trends&p=K&x=stroke`);
await page.waitForSelector(".trend-plot canvas");
console.log(`first picture after ${Date.now() - start} ms, of which the database was read for ${answered.toFixed(0)} ms`);
await page.waitForSelector(".plots[data-exact='1']");
console.log(`lowest and highest values of all collected after ${((Date.now() - start) / 1000).toFixed(1)} s`);
await page.waitForTimeout(1500);
console.log(`the browser alone: ${await panned({ seconds, pixels: 0, back: onAndOn })}`);
for (const span of [strokes / 2, strokes / 10, strokes / 100, strokes / 1000].map(Math.round).filter((n) => n > 1000)) {
  const from = Math.round((strokes - span) / 4);
  const pan = async (way, axis) => {
    await page.goto(`${served.address}#view=trends&p=K&x=${axis}&from=${from}&to=${from + span}`);
    await page.waitForTimeout(1500);
    let requests = 0, bytes = 0;
    const count = async (response) => { ++requests; bytes += (await response.body().catch(() => "")).length; };
    page.on("response", count);
    console.log(`${span} strokes wide, ${way.name}: ${await panned({ seconds, ...way })}`);
    page.off("response", count);
    if (bytes > 0) console.log(`  ${requests} requests, ${(bytes / requests / 1000).toFixed(0)} kB each`);
  };
  await pan({ name: "to and fro", pixels: 120, back: 4 }, "stroke");
  await pan({ name: "on and on, a width a second", pixels: 20, back: span * 8 > strokes ? 120 : onAndOn }, "stroke");
  await pan({ name: "the same over dates", pixels: 20, back: span * 8 > strokes ? 120 : onAndOn }, "time");
  const times = [];
  for (let k = 0; k < 40; ++k) {
    const first = Math.max(0, Math.round(from + (k - 20) * span / 40 - span / 2));
    start = performance.now();
    await (await fetch(`${served.address}api/v1/watch/trend?machine=die_cushion&parameter=K&first=${first}&end=${first + 2 * span}&bins=2000`)).arrayBuffer();
    times.push(performance.now() - start);
  }
  console.log(`  requests ${at(times, 0.5)} ms in the median, ${at(times, 0.99)} ms at p99`);
}
await chromium.close();
await served.stop();
place.remove();
