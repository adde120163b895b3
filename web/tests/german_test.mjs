// A German reader meets no English sentence: a walk through the pages with logs, an alarm and its trend.
// node --test german_test.mjs. HYDROSCOPE names the program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { endBrowser, startBrowser, visitIn, visitServed } from "./browser_fixture.mjs";
import { assertGerman } from "./german.mjs";
import { addValveChecks, makeHistory } from "./history.mjs";
import { folder, run, serve } from "./program.mjs";

const machines = fileURLToPath(new URL("../../machines", import.meta.url));
const place = folder();
const visit = (t, words) => visitIn(place.path, t, words, { locale: "de-DE" });

before(async () => {
  await startBrowser();
  run(["simulate", "press", "--out", "leak.csv", "--seconds", "60", "--seed", "4", "--effect", "internal_leakage=4e-12"], place.path);
  run(["simulate", "press", "--out", "drift.csv", "--seconds", "60", "--seed", "2", "--effect", "pressure_offset"], place.path);
  run(["simulate", "valve", "--out", "new.csv"], place.path);
  run(["simulate", "valve", "--out", "worn.csv", "--f0", "170", "--frequencies", "20,40,60,80,100", "--seed", "2"], place.path);  // far below the corner: a warning
});
after(async () => {
  await endBrowser();
  place.remove();
});

/** The steps of the workbench. */
async function walk(page, address, steps) {
  for (const [step, there] of steps) {
    await page.goto(`${address}#step=${step}`);
    await page.waitForSelector(there);
    await page.waitForSelector("[data-verdict]");
    await assertGerman(page, step);
  }
}
const steps = [["check", ".machine .mark"], ["compare", ".centre .plot canvas"], ["confirm", ".save"]];

test("the first run is German", async (t) => {
  const { page, address } = await visit(t, []);
  await page.goto(address);
  await page.waitForSelector(".drop");
  await assertGerman(page, "start");
  await page.setInputFiles("input[type=file]", { name: "worte.csv", mimeType: "text/csv", buffer: Buffer.from("only words\n") });
  await page.waitForSelector(".problem:has-text(\"Log 'worte.csv': keine Zahlenreihen gefunden\")");
  await assertGerman(page, "no log");
  await page.setInputFiles("input[type=file]", join(place.path, "leak.csv"));
  await page.waitForSelector(".mapping .pin.sure");
  await assertGerman(page, "mapping");
  await page.fill("input[name=A_A-bore]", "126.16");
  await page.waitForSelector(".log-view .plot canvas");
  await assertGerman(page, "mapping, ready");
  assert.doesNotMatch(await page.locator(".pins").innerText(), /degC/);  // in the file alone
});

test("the effects that are proposed for a machine of one's own are German too", async (t) => {
  const rows = Array.from({ length: 6000 }, (_, k) => {
    const time = 0.01 * k, speed = Math.cos(0.9 * time), pressure = 90 + 40 * Math.sin(0.5 * time), noise = ((k * 7919) % 101) / 101 - 0.5;
    return [time.toFixed(2), (pressure * 400 - 1500 * Math.sign(speed) + 10 * noise).toFixed(3), (pressure + 0.05 * noise).toFixed(4), (100 + (30 / 0.9) * Math.sin(0.9 * time) + 0.02 * noise).toFixed(4)].join();
  });
  writeFileSync(join(place.path, "heber.csv"), ["t,F [N],p_A [bar],z [mm]", ...rows].join("\n"));
  const { page, address } = await visit(t, []);
  await page.goto(address);
  await page.setInputFiles("input[type=file]", join(place.path, "heber.csv"));
  await page.waitForSelector("p.verdict.good");
  await page.click(".mapping > button.primary");
  await page.waitForSelector(".ranking :text('Reibung fester Größe gegen die Bewegung')");
});

test("the workbench is German: a leak, effects that cannot be told apart", async (t) => {
  for (const [log, machine, more] of [["leak.csv", "die_cushion", [["locate", ".heat .cell"], ["add", ".preview"]]], ["drift.csv", "die_cushion", []]]) {
    const { page, address } = await visit(t, [log, "--machine", join(machines, `${machine}.toml`)]);
    await walk(page, address, [...steps, ...more]);
    if (log === "leak.csv") {
      await page.goto(`${address}#step=check`);
      await page.waitForSelector("td:has-text('erst finden, was dem Modell fehlt')");  // a button leads there, no command
    }
  }
});

test("the response of a valve is German, alone and beside an earlier one", async (t) => {
  const { page, address } = await visit(t, ["new.csv", "worn.csv", "--machine", join(machines, "valve_sweep.toml")]);
  await walk(page, address, [...steps, ["locate", ".plot canvas"], ["add", "h1"]]);
  assert.match(await page.locator(".verdict-panel").innerText(), /bis zu höheren Frequenzen messen/);
  await page.selectOption("select[name=hold-out]", "new.csv");
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector(".centre td strong");
  await assertGerman(page, "two valves");
});

test("what changed of a test cylinder is German, and no table is cut off", async (t) => {
  run(["simulate", "test-cylinder", "--out", "cylinder.csv", "--valve", "38"], place.path);
  const { page, address } = await visit(t, ["cylinder.csv", "--machine", join(machines, "test_cylinder.toml")]);
  await walk(page, address, [["compare", ".centre .plot canvas"]]);
  const cut = () => [...document.querySelectorAll(".scroll")].filter((box) => box.scrollWidth > box.clientWidth + 1).map((box) => box.getAttribute("aria-label"));
  assert.deepEqual(await page.evaluate(cut), []);
});

test("what is watched is German: overview, trends with their marks, an alarm with its journal, valve checks", async (t) => {
  makeHistory(place.path);
  addValveChecks(place.path);
  const { page, address } = await visit(t, ["--db", "press.db", "--machine", "press.toml"]);
  for (const [view, there] of [["overview", ".tile tbody tr"], ["trends&p=K,V0", ".trend-plot canvas"], ["trends&p=K&x=oil", ".trend-plot canvas"],
    ["alarms", ".alarm-table"], ["alarms&alarm=die_cushion/internal_leakage", ".journal li"], ["valve", ".bode canvas"],
    ["learn&from=0&to=100", ".learn .trend-plot canvas"], ["scada", ".tags tbody tr"]]) {
    await page.goto(`${address}#view=${view}`);
    await page.waitForSelector(there);
    await assertGerman(page, view);
    if (view.startsWith("learn")) assert.match(await page.locator(".learn").innerText(), /Hub 99 · Referenz 1 gelernt aus 0 bis 99/, "counted as everywhere");
  }
});

test("what goes wrong is told in German: an expression, too few strokes, a wrong password", async (t) => {
  run(["simulate", "press", "--out", "short.csv", "--seconds", "8", "--seed", "1"], place.path);
  const { page, address } = await visit(t, ["short.csv", "--machine", join(machines, "die_cushion.toml")]);
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector(".verdict-panel .problem:has-text('im Gate')");
  await page.goto(`${address}#step=add`);
  await page.waitForSelector(".centre .problem");
  await assertGerman(page, "too few strokes");

  const worked = await visit(t, ["leak.csv", "--machine", join(machines, "die_cushion.toml")]);
  await worked.page.goto(`${worked.address}#step=add`);
  await worked.page.click("text=Einen eigenen Effekt schreiben");
  await worked.page.fill("input[name=own-expression]", "p_A*sgn(z)");
  await worked.page.waitForSelector(".own pre.problem:has-text('unbekannte Funktion')");
  const said = worked.page.locator(".own pre.problem");
  assert.match(await said.innerText(), /war "sign" gemeint\?[^]*p_A\*sgn\(z\)\n +\^/);
  assert.equal(await said.locator("[lang=en]").count(), 0);

  run(["users", "--db", "guarded.db", "add", "anna", "--role", "admin"], place.path, "long enough to guess\n");
  const guarded = await visitServed(await serve([join(machines, "press_live.toml"), "--db", "guarded.db"], place.path), t, { locale: "de-DE" });
  await guarded.page.goto(`${guarded.address}#view=login`);
  await guarded.page.fill("input[name=name]", "anna");
  await guarded.page.fill("input[name=password]", "wrong wrong wrong");
  await guarded.page.click(".login button.primary");
  await guarded.page.waitForSelector(".login .problem:has-text('Name oder Passwort ist falsch')");
  await guarded.page.fill("input[name=password]", "long enough to guess");
  await guarded.page.click(".login button.primary");
  await guarded.page.waitForSelector(".account");
  for (const [view, there] of [["service", ".service .log tbody tr"], ["audit", ".audit tbody tr"]]) {
    await guarded.page.goto(`${guarded.address}#view=${view}`);
    await guarded.page.waitForSelector(there);
    await assertGerman(guarded.page, view);
  }
  const changes = (await guarded.page.locator(".audit tbody tr").allInnerTexts()).map((row) => row.replace(/\s+/g, " "));
  assert.match(changes[0], /anna verwaltet 127\.0\.0\.1 Anmeldung ✓/);
  assert.match(changes[1], /anna 127\.0\.0\.1 Anmeldung abgelehnt/);
  assert.match(changes[2], /Befehlszeile Benutzer angelegt anna, admin ✓/);
});
