// What SCADA systems read of a running service, beside what the page shows of it, in a real browser: node --test scada_test.mjs.
// HYDROSCOPE names the program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { connect } from "node:net";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { assertAccessible, assertFits, endBrowser, startBrowser, until, visitServed } from "./browser_fixture.mjs";
import { folder, program, run, serve } from "./program.mjs";

const place = folder();
const port = 50_100 + (process.pid % 9_000), domain = 20 + (process.pid % 200);
let press;

/** A press of two cylinders on the wire, and a service that tells SCADA systems of them in another order than their names have. */
before(async () => {
  const text = readFileSync(fileURLToPath(new URL("../../machines/press_live.toml", import.meta.url)), "utf8")
    .replace(/axes = \[.*\]/, 'axes = ["cushion_2", "cushion_1"]').replace("domain = 0", `domain = ${domain}`).replace("port = 1502", `port = ${41_000 + (process.pid % 9_000)}`);
  writeFileSync(join(place.path, "live.toml"), `${text}\n[feeds.modbus]\nport = ${port}\n[feeds.dds]\ndomain = ${domain}\ntopic = "plant"\n`);
  press = spawn(program, ["simulate", "press", "--serve", "live.toml", "--speed", "5", "--seed", "4"], { cwd: place.path, stdio: ["pipe", "ignore", "ignore"] });
  await startBrowser();
});
after(async () => {
  await endBrowser();
  press.kill("SIGTERM");
  place.remove();
});

const registersOf = { u16: 1, u32: 2, float32: 2, "text, 16 characters": 8, "text, 32 characters": 16 };

/** What a Modbus client reads at an address, as it would show it. */
class ModbusClient {
  constructor() { this.link = connect(port, "127.0.0.1"); this.waiting = []; this.got = Buffer.alloc(0); this.link.on("data", (piece) => this.take(piece)); }
  end() { this.link.destroy(); }
  take(piece) {
    this.got = Buffer.concat([this.got, piece]);
    while (this.got.length >= 6 && this.got.length >= 6 + this.got.readUInt16BE(4)) {
      const size = 6 + this.got.readUInt16BE(4);
      this.waiting.shift()(this.got.subarray(9, size));
      this.got = this.got.subarray(size);
    }
  }
  read(address, type) {
    const request = Buffer.from([0, 1, 0, 0, 0, 6, 1, 3, address >> 8, address & 255, 0, registersOf[type]]);
    return new Promise((resolve) => { this.waiting.push((words) => resolve(this.shown(words, type))); this.link.write(request); });
  }
  shown(words, type) {
    if (type === "u16") return String(words.readUInt16BE(0));
    if (type === "u32") return String(words.readUInt32BE(0));
    if (type === "float32") { const value = words.readFloatBE(0); return Number.isNaN(value) ? "–" : String(Number(value.toPrecision(6))); }
    return words.toString("latin1").replace(/\0+$/, "");
  }
}

/** The rows of the table that fit. */
const rowsOf = (page) => page.locator(".tags tbody tr").evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.innerText.trim())));
const valueOf = async (page, name) => (await rowsOf(page)).find((row) => row[2].startsWith(name))[4];
const asNumber = (text) => (text !== "" && !Number.isNaN(Number(text)) ? String(Number(text)) : text);
const moving = /heartbeat|time of this picture|age/;  // between the look of the page and that of the client

test("every register on the page says what a Modbus client reads, and goes with it", async (t) => {
  const served = await serve(["live.toml", "--db", "live.db"], place.path);
  const { page, address } = await visitServed(served, t);
  const client = new ModbusClient();
  t.after(() => client.end());
  await page.goto(`${address}#view=scada&feed=modbus`);
  await page.waitForSelector(".tags tr:has-text('K, value')");
  const links = await page.locator(".scada table").first().innerText();
  assert.match(links, new RegExp(`modbus 127\\.0\\.0\\.1:${port}[^]*open;[^]*dds plant domain ${domain}[^]*publishing`));

  let strokes = 0;
  for (const round of [0, 1]) {
    if (round > 0) press.stdin.write("run\n");
    for (const end = Date.now() + 120_000; Number(await client.read(1028, "u32")) < strokes + 3 && Date.now() < end;) await page.waitForTimeout(200);
    press.stdin.write("pause\n");
    for (let last = ""; last !== (last = await client.read(1028, "u32"));) await page.waitForTimeout(3_000);
    const now = Number(await client.read(1028, "u32"));
    assert.ok(now >= strokes + 3, `${now} strokes after ${strokes}`);
    strokes = now;
    await page.waitForSelector(`.tags tr:has-text('strokes stored'):has-text('${strokes}')`);
    await page.waitForTimeout(3_000);
    let looked = 0;
    for (const [feed, register, name, type, value] of await rowsOf(page)) {
      assert.equal(feed, "modbus");
      if (moving.test(name)) continue;
      assert.equal(asNumber(value), await client.read(Number(register), type), `${register} ${name}`);
      ++looked;
    }
    assert.ok(looked > 80, `${looked} registers`);
  }
  assert.deepEqual([await client.read(1032, "text, 16 characters"), await valueOf(page, "press/cushion_2 · name")], ["cushion_2", "cushion_2"], "in the order of the machine file");

  // what moves while nothing is stored moves on the page
  const beat = Number(await valueOf(page, "heartbeat"));
  for (const end = Date.now() + 20_000; Number(await valueOf(page, "heartbeat")) === beat && Date.now() < end;) await page.waitForTimeout(500);
  const [shown, read] = [Number(await valueOf(page, "heartbeat")), Number(await client.read(3, "u16"))];
  assert.ok(shown > beat && shown <= read && read - shown < 200, `${beat}, then ${shown}; ${read} is read`);
  await page.goto(`${address}#view=service`);
  await page.waitForSelector(".service[data-state]");
  const up = () => page.locator(".service > p").first().innerText();
  const before = await up();
  for (const end = Date.now() + 20_000; (await up()) === before && Date.now() < end;) await page.waitForTimeout(500);
  assert.notEqual(await up(), before, "its view goes on, too");

  // what DDS publishes
  await page.goto(`${address}#view=scada&feed=dds`);
  await page.waitForSelector(".tags tr:has-text('plant/findings')");
  const rows = await rowsOf(page);
  const health = rows.find((row) => row[1] === "plant/findings" && row[2].startsWith("press/cushion_2 · health, health"));
  assert.deepEqual([health[3], health[4]], ["char", "C"]);
  assert.equal(rows.filter((row) => row[1] === "plant/alarms").length, 23);
  await assertAccessible(page, "scada");
  await assertFits(page, "scada");
  const download = page.waitForEvent("download");
  await page.click("button:has-text('CSV')");
  const csv = readFileSync(await (await download).path(), "utf8");
  assert.match(csv, /^dds,press\/cushion_2,plant\/findings,"health, health",char,,/m);
  assert.equal(run(["alarms", "--modbus", `127.0.0.1:${port}`], place.path).includes("cushion_2"), true, "the command line reads the same");
});
