// Models with states, balances and effects of one's own in a real browser: node --test own_models_test.mjs. HYDROSCOPE names the
// program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { assertAccessible, drop, endBrowser, errorsOfVersions, pagesOf, startBrowser, until, visitIn } from "./browser_fixture.mjs";
import { assertGerman } from "./german.mjs";
import { folder, run } from "./program.mjs";

const machines = fileURLToPath(new URL("../../machines", import.meta.url));
const place = folder();

before(startBrowser);
after(async () => {
  await endBrowser();
  place.remove();
});

/** A page over these words of `open`, in the folder of the logs. */
const visit = (t, words, options) => visitIn(place.path, t, words, options);

test("a model with states is drawn running by itself, each output beside its measurement, and told in both languages", async (t) => {
  run(["simulate", "pump", "--out", "pump.csv", "--seconds", "1"], place.path);
  const { page, address } = await visit(t, ["pump.csv", "--machine", join(machines, "pump.toml")]);
  await page.goto(`${address}#step=check`);
  await page.waitForSelector(".machine [data-mark=shaft_speed]");
  assert.equal(await page.locator(".machine .mark").count(), 5);
  assert.ok(await page.locator(".machine .part circle").count() > 0, "the drawing is there");
  await page.waitForSelector("text=/; 1 episode$/");  // one, in words
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector(".centre .plot canvas");
  assert.match(await page.locator(".centre").innerText(), /Running by itself the model errs by [01]\.\d+\s%;/);
  await page.selectOption("label:has-text('Signal') select", "control_position");
  const { outputs } = await (await fetch(`${address}api/v1/strokes?stroke=0`)).json();
  assert.deepEqual(outputs.map((output) => [output.name, output.unit]), [["outlet_pressure", "bar"], ["control_pressure", "bar"], ["control_position", "mm"]]);
  assert.match(await page.locator(".centre").innerText(), /95\s% of sensor noise, at most/);
  for (const { name, measured, modelled, noise } of outputs) {
    const errors = measured.flatMap((value, k) => (value === null ? [] : [Math.abs(value - modelled[k])])), span = Math.max(...modelled) - Math.min(...modelled);
    assert.ok(errors.length > 50 && errors.reduce((sum, e) => sum + e, 0) / errors.length < 0.05 * span, `${name}: ${errors.length} readings`);
    assert.ok(errors.filter((error) => error < 1.96 * noise).length > 0.9 * errors.length, `${name}: within its band of ${noise}`);
  }
  await page.waitForSelector("[data-verdict]");
  assert.match(await page.locator(".ranking").innerText(), /~[01]\.\d+[^]*~ estimated without fitting/);
  await assertAccessible(page, "states, compare");
  await page.goto(`${address}#step=locate`);
  await page.waitForSelector(".heat .cell");
  assert.match(await page.locator(".centre").innerText(), /The map is flat: [^]*Of (outlet_pressure|control_pressure|control_position); these signals predict 0\s%/);
  await page.selectOption(".top select >> nth=-1", "de");
  for (const [step, there] of [["check", ".machine .mark"], ["compare", ".centre .plot canvas"], ["locate", ".heat .cell"], ["confirm", ".save"]]) {
    await page.goto(`${address}#step=${step}`);
    await page.waitForSelector(there);
    await assertGerman(page, step);
  }
  assert.match(await page.locator(".headline").innerText(), /^Das Modell beschreibt kurze Läufe dieser Episoden, was keine Entwarnung ist/);
});

/** Runs of a cylinder with a dry seal at constant pressures, in the layout of machines/seal_friction.toml. */
function sealLogs() {
  let seed = 1;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
  const normal = () => Math.sqrt(-2 * Math.log(random())) * Math.cos(2 * Math.PI * random());
  const area = (Math.PI / 4) * 0.0257 ** 2;
  return [1, 3.5, 6].map((bar) => {
    let x = 0, text = "";
    for (let row = 0; row < 3000; ++row) {
      const phase = (row * 0.01) % 4;  // s: 1.6 out, 0.4 rest, 1.6 back, 0.4 rest
      x += 0.01 * (phase < 1.6 ? 0.013 : phase < 2 ? 0 : phase < 3.6 ? -0.013 : 0);
      const sign = phase >= 1.8 && phase < 3.8 ? -1 : 1;
      const p = 1e5 * (bar + 0.05 * sign) + 200 * Math.sin(0.7 * row);
      const force = area * p + 1 + 2e-5 * p * sign + 0.3 * normal();
      text += `${row * 10}\t0\t0\t0\t${1e3 * x + 0.004 * normal()}\t${p / 1e5 + 0.0005 * normal()}\t${force}\n`;
    }
    const file = join(place.path, `seal_${bar}.csv`);
    writeFileSync(file, text);
    return file;
  });
}

test("a machine that is no cushion goes the same way, with its own effect", async (t) => {
  const { page, address } = await visit(t, []);
  await page.goto(address);
  await drop(page, [...sealLogs(), join(machines, "seal_friction.toml")]);
  await page.waitForSelector("[data-effect=pressure_friction]");
  await page.selectOption("select[name=hold-out]", "seal_3.5.csv");
  await page.waitForSelector("[data-held-out]");
  const unseen = Number(await page.locator("[data-held-out]").getAttribute("data-held-out"));
  assert.ok(unseen > 3, `the model errs by ${unseen} N on the log held out`);
  await page.waitForSelector("[data-effect=pressure_friction]");
  assert.match(await page.locator(".centre").innerText(), /\d\sN/);
  const log = async () => (await page.locator(".scrubber label span").innerText()).match(/ · (seal_[\d.]+\.csv) · /)[1];  // the stroke's own
  const worst = await log();
  await page.locator(".scrubber input").press("End");
  await until(page, `!document.querySelector(".scrubber label span").textContent.includes(${JSON.stringify(worst)})`);
  assert.ok(![worst, await log()].includes("seal_3.5.csv"), "the log held out has no strokes here");
  await page.click("[data-effect=pressure_friction]");
  await page.waitForSelector("[data-preview]");
  await page.click("[data-add=pressure_friction]");
  await page.waitForSelector("[data-error]");
  await page.waitForSelector("[data-verdict=adequate]");
  const [base, added] = (await errorsOfVersions(page)).map(parseFloat);
  assert.ok(added < 0.3 * base, `the error falls from ${base} to ${added} N`);
});

test("what to record of a machine of one's own stands in the units that its signals are shown in", async (t) => {
  sealLogs();
  const limits = 'signals = { p = { min = 1, max = 7, unit = "bar" }, "abs(ddt(x))" = { min = 3, max = 30, unit = "mm/s" } }';
  writeFileSync(join(place.path, "limits.toml"), `${readFileSync(join(machines, "seal_friction.toml"), "utf8")}\n[experiment]\n${limits}\n`);
  const { page, address } = await visit(t, ["seal_6.csv", "--machine", "limits.toml"]);
  await page.goto(address);
  await page.waitForSelector(".experiment tr:has-text('p') td:has-text('bar')");
  assert.match(await page.locator(".experiment tbody").innerText(), /p[^\n]*\t1\sbar\n/);
  await page.emulateMedia({ media: "print" });
  assert.match(await page.locator("body").innerText(), /^seal_friction · seal_6.csv · printed [^]*What to record next[^]*Setting\tValue/, "what is recorded of which machine, and no button");
  assert.equal(await pagesOf(page), 1, "on one sheet");
  await page.goto(`${address}#step=check`);
  await page.evaluate(() => document.querySelector(".experiment").remove());
  assert.ok(await page.locator("h1:has-text('Can this log be believed?')").isVisible(), "other pages are printed as they stand");
});

test("a law that the machine file lacks is proposed, and written as an effect by a click", async (t) => {
  const effect = '[[effect]]\nid = "viscous"\nterms = { b = "ddt(x)" }\nmin = 0\n';
  writeFileSync(join(place.path, "viscous.toml"), readFileSync(join(machines, "seal_friction.toml"), "utf8").replace(/\[\[effect\]\][^]*/, effect));
  sealLogs();
  const { page, address } = await visit(t, ["seal_1.csv", "seal_3.5.csv", "seal_6.csv", "--machine", "viscous.toml"]);
  await page.goto(address);
  await page.waitForSelector("[data-verdict=unknown]");
  const law = await page.locator("[data-law]").first().getAttribute("data-law");
  assert.match(law, /p\*|ddt\(x\)/);
  await page.click("[data-law]");
  assert.equal(await page.inputValue("input[name=own-expression]"), law);
  await page.waitForSelector(".own .verdict.good");
});

test("an expression of one's own is checked while it is written, tried and added", async (t) => {
  const { page, address } = await visit(t, []);
  const own = join(place.path, "own.toml");  // a library that does not hold what is missing
  writeFileSync(own, readFileSync(join(machines, "seal_friction.toml"), "utf8").replace(/\[\[effect\]\][^]*/, ""));
  await page.goto(address);
  await drop(page, [...sealLogs(), own]);
  await page.waitForSelector("[data-verdict=unknown]");
  await page.click(".stepper button:has-text('Add')");
  await page.click("text=Write an effect of your own");
  await page.fill("input[name=own-id]", "dry_seal");
  await page.fill("input[name=own-expression]", "p*sign(ddt(y))");
  await page.waitForSelector(".own pre.problem");
  assert.match(await page.locator(".own pre.problem").innerText(), /unknown signal "y"[^]*\n +\^/);
  assert.ok(await page.locator(".own button.primary").isDisabled());
  assert.equal(await page.locator("[data-course]").count(), 0, "what is wrong has no course");
  await page.fill("input[name=own-expression]", "p*sign(ddt(x))");
  await page.waitForSelector("[data-course] canvas");
  assert.match(await page.locator("[data-course]").innerText(), /the term without its size, stroke \d+/);
  await page.reload();  // what was typed outlives it, as it does a restart of the program
  await page.waitForSelector("[data-course] canvas");
  assert.equal(await page.inputValue("input[name=own-expression]"), "p*sign(ddt(x))");
  assert.equal(await page.inputValue("input[name=own-id]"), "dry_seal");
  const { token } = (await (await fetch(`${address}api/v1/session`)).json()).user;
  const termOf = async (expression) => (await (await fetch(`${address}api/v1/effect`, { method: "POST", headers: { "X-Hydroscope-Token": token }, body: JSON.stringify({ id: "looked_at", expression }) })).json()).course;
  const [plain, twice] = [await termOf("p"), await termOf("2*p")];
  assert.equal(plain.unit, "Pa");
  assert.ok(plain.values.length > 10 && plain.values.every((value, k) => value === null || Math.abs(twice.values[k] - 2 * value) < 1e-6 * Math.abs(value)));
  const { signals } = await (await fetch(`${address}api/v1/strokes?stroke=${plain.stroke}`)).json();
  const bar = signals.find((signal) => signal.name === "p").values, known = plain.values.filter((value) => value !== null).map((value) => value / 1e5);
  assert.ok(Math.min(...known) > Math.min(...bar) - 1 && Math.max(...known) < Math.max(...bar) + 1, "the term p over the stroke is its signal p");
  await page.waitForSelector(".own .verdict.good");
  await page.click(".own button.primary");
  await page.waitForSelector("[data-preview]");
  await page.click("[data-add=dry_seal]");
  await page.waitForSelector("[data-error]");
  await page.waitForSelector("[data-verdict=adequate]");
  const [base, added] = (await errorsOfVersions(page)).map(parseFloat);
  assert.ok(added < 0.3 * base, `the error falls from ${base} to ${added} N`);
});
