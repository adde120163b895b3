// Pictures of every page and state: node screenshots.mjs FOLDER [watch | service | documents]: those of a database, of a
// service, or of the documents, alone. scripts/screenshots.sh calls it.

import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { addValveChecks, copyHistory, makeBeginning, makeFleet, makeHistory } from "./history.mjs";
import { patience } from "./browser_fixture.mjs";
import { browser, folder, open, run, serve } from "./program.mjs";
import { makeSpindle } from "./spindle.mjs";

const out = resolve(process.argv[2] ?? "out/screenshots"), only = process.argv[3];
const machine = fileURLToPath(new URL("../../machines/die_cushion.toml", import.meta.url));
const liveMachine = fileURLToPath(new URL("../../machines/press_live.toml", import.meta.url));
const cylinderMachine = fileURLToPath(new URL("../../machines/test_cylinder.toml", import.meta.url));
const valveMachine = fileURLToPath(new URL("../../machines/valve_sweep.toml", import.meta.url));
const pumpMachine = fileURLToPath(new URL("../../machines/pump.toml", import.meta.url));
mkdirSync(out, { recursive: true });
const place = folder();
run(["simulate", "press", "--out", "leak.csv", "--seconds", "90", "--seed", "4", "--effect", "internal_leakage=4e-12"], place.path);
run(["simulate", "press", "--out", "drift.csv", "--seconds", "60", "--seed", "2", "--effect", "pressure_offset"], place.path);
run(["simulate", "pump", "--out", "pump.csv", "--seconds", "2"], place.path);
run(["simulate", "test-cylinder", "--out", "cylinder.csv", "--valve", "38"], place.path);
run(["simulate", "valve", "--out", "new.csv"], place.path);
run(["simulate", "valve", "--out", "worn.csv", "--f0", "120", "--damping", "0.9", "--seed", "2"], place.path);

makeSpindle(place.path);
makeHistory(place.path);
addValveChecks(place.path);
makeBeginning(place.path);
makeFleet(place.path);

const wide = { viewport: { width: 1500, height: 1000 } }, phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
const chromium = await browser();

/** The views of a database. */
async function takeWatching(page, shoot) {
  const learning = await open(["--db", "learning.db", "--machine", "press.toml"], place.path);
  await page.goto(learning.address);
  await page.waitForSelector(".tile .health");
  await shoot(page, "watch-learning");
  await learning.stop();
  const fleet = await open(["--db", "fleet.db", "--machine", "press.toml"], place.path);
  await page.goto(fleet.address);
  await page.waitForSelector(".tile >> nth=11");
  await shoot(page, "watch-fleet");
  await page.goto(`${fleet.address}#view=alarms`);
  await page.waitForSelector(".alarm-table");
  await shoot(page, "watch-fleet-alarms");
  await fleet.stop();
  const watched = await open(["--db", "press.db", "--machine", "press.toml"], place.path);
  for (const [state, view, there] of [
    ["watch-overview", "overview", ".tile tbody tr"], ["watch-trend", "trends&p=K", ".trend-plot canvas"],
    ["watch-trends", "trends&p=K,V0,Q_vn&x=stroke", ".trend-plot canvas"], ["watch-oil", "trends&p=K&x=oil", ".trend-plot canvas"],
    ["watch-alarms", "alarms", ".alarm-table"], ["watch-alarm", "alarms&alarm=die_cushion/internal_leakage", ".journal li"],
    ["watch-valve", "valve", ".bode canvas"], ["watch-learn", "learn&from=0&to=100", ".learn .trend-plot canvas"], ["watch-scada", "scada", ".tags tbody tr"],
  ]) {
    await page.goto(`${watched.address}#view=${view}`);
    await page.waitForSelector(there);
    await shoot(page, state);
  }
  await page.goto(`${watched.address}#view=alarms&alarm=die_cushion/internal_leakage`);
  await page.waitForSelector(".journal li");
  await page.emulateMedia({ media: "print" });
  await shoot(page, "watch-work-order");
  await page.emulateMedia({ media: "screen" });
  await watched.stop();
}

/** The page of a service: login, an alarm as operators see it, what was changed. */
async function takeService(page, shoot, name) {
  copyHistory(place.path, name);
  run(["users", "--db", `${name}.db`, "add", "anna", "--role", "admin"], place.path, "long enough to guess\n");
  const served = await serve([liveMachine, "--db", `${name}.db`], place.path);
  await page.goto(`${served.address}#view=login`);
  await page.waitForSelector(".login");
  await shoot(page, "login");
  for (const [password, there] of [["a wrong password", ".login .problem"], ["long enough to guess", ".account"]]) {
    await page.fill("input[name=name]", "anna");
    await page.fill("input[name=password]", password);
    await page.click(".login button.primary");
    await page.waitForSelector(there);
    if (there !== ".account") await shoot(page, "login-refused");
  }
  await page.goto(`${served.address}#view=alarms&alarm=die_cushion/internal_leakage`);
  await page.fill(".act textarea", "seal ordered");
  await shoot(page, "service-alarm");
  await page.click(".act button.primary");
  await page.waitForSelector(".detail[data-state=ACKED]");
  await page.goto(`${served.address}#view=audit`);
  await page.waitForSelector(".audit tbody tr");
  await shoot(page, "service-changes");
  for (const [view, there] of [["overview", ".tile"], ["service", ".service table"]]) {
    await page.goto(`${served.address}#view=${view}`);
    await page.waitForSelector(there);
    await shoot(page, `service-${view}`);
  }
  await served.stop();
}

/** The page of a machine of one's own: without a log, with what is wrong while it is written, and whole. */
async function takeOwn(page, shoot) {
  const own = await open([], place.path);
  await page.goto(`${own.address}#page=own`);
  await page.waitForSelector(".own-machine .balance");
  await shoot(page, "own-start");
  await page.setInputFiles("input[type=file]", join(place.path, "spindel.csv"));
  await page.waitForSelector(".own-machine .pin");
  const [force, pressure, way] = await page.locator(".columns .role button").allInnerTexts();
  await page.fill("input[name=balance-output]", force);
  await page.fill("input[name=balance-expression-0]", `${pressure} + ${way}`);
  await page.waitForSelector(".balance pre.problem");
  await page.waitForSelector(".log-view .plot canvas");
  await shoot(page, "own-wrong");
  await page.fill("input[name=balance-expression-0]", pressure);
  await page.fill("input[name=effect-id-0]", "reibung");
  await page.fill("input[name=effect-expression-0]", `sign(ddt(${way}))`);
  await page.uncheck(".effects input[type=checkbox] >> nth=0");
  await page.waitForSelector(".effects .law .plot canvas");
  await page.waitForSelector("p.verdict.good");
  await shoot(page, "own");
  await own.stop();
}

/** The same states in each look. */
async function take(name, device, colorScheme, locale) {
  const shoot = async (page, state) => {
    await page.waitForTimeout(250);
    await page.screenshot({ path: join(out, `${state}-${name}.png`), fullPage: true });
    if (device.hasTouch) await devTools.send("Emulation.setTouchEmulationEnabled", { enabled: true, maxTouchPoints: 1 });  // a whole page takes it away
  };
  const context = await chromium.newContext({ ...device, colorScheme, locale });
  const page = await context.newPage(), devTools = await context.newCDPSession(page);
  page.setDefaultTimeout(patience);
  if (only !== "service") await takeWatching(page, shoot);
  await takeService(page, shoot, name);
  if (only === "watch" || only === "service") return context.close();

  await takeOwn(page, shoot);

  const first = await open([], place.path);
  await page.goto(first.address);
  await page.waitForSelector(".drop");
  await shoot(page, "start");
  await page.setInputFiles("input[type=file]", { name: "bad.csv", mimeType: "text/csv", buffer: Buffer.from("no numbers\n") });
  await page.waitForSelector(".problem");
  await shoot(page, "start-error");
  await page.setInputFiles("input[type=file]", join(place.path, "leak.csv"));
  await page.waitForSelector(".mapping .pin");
  await shoot(page, "mapping");
  await page.fill("input[name=A_A-bore]", "126.16");
  await page.waitForSelector(".log-view .plot canvas");
  await shoot(page, "mapping-ready");
  await page.locator(".gate-plot canvas").first().scrollIntoViewIfNeeded();
  await shoot(page, "mapping-gate");
  await first.stop();
  await page.waitForSelector(".lost");
  await shoot(page, "lost");

  const work = await open(["leak.csv", "--machine", machine], place.path);
  await page.goto(`${work.address}#step=check`);
  await page.waitForSelector(".ranking table");
  await page.waitForSelector(".log-view canvas");
  await shoot(page, "check");
  for (const step of ["compare", "locate", "add", "confirm"]) {
    await page.goto(`${work.address}#step=${step}`);
    await page.waitForSelector(step === "compare" ? ".plot canvas" : step === "locate" ? ".heat .cell" : step === "add" ? ".preview table" : ".save");
    await shoot(page, step);
  }
  const region = "p_A:33:85|speed:-51:-35";
  for (const [step, there] of [["locate", "[data-ranked-there]"], ["compare", ".plot canvas"]]) {
    await page.goto(`${work.address}#step=${step}&map=${encodeURIComponent("p_A × speed")}&region=${encodeURIComponent(region)}`);
    await page.waitForSelector(there);
    await shoot(page, `${step}-region`);
  }
  await page.click(".unit-menu summary");
  await shoot(page, "units");
  await page.goto(`${work.address}#step=compare&drawn=free`);
  await page.waitForSelector(".plot canvas");
  await shoot(page, "free-run");
  await page.goto(`${work.address}#step=add`);
  await page.click("[data-add]:not([disabled])");
  await page.waitForSelector("[data-error]");
  await page.waitForSelector("[data-verdict=adequate]");
  await page.waitForSelector(".version-pair canvas");
  await shoot(page, "confirmed");
  await page.goto(`${work.address}#step=compare`);
  await page.waitForSelector(".plot canvas");
  await shoot(page, "compare-two-versions");
  await work.stop();

  const two = await open(["leak.csv", "drift.csv", "--machine", machine], place.path);
  await page.goto(`${two.address}#step=compare`);
  await page.waitForSelector("[data-verdict]");
  await page.selectOption("select[name=hold-out]", "drift.csv");
  await page.waitForSelector("[data-held-out]");
  await page.waitForSelector("[data-verdict]");
  await shoot(page, "held-out");
  await page.goto(`${two.address}#step=add`);
  await page.click(".own summary");
  await page.fill("input[name=own-expression]", "p_A*sgn(z)");
  await page.waitForSelector(".own pre.problem");
  await page.locator(".own pre.problem").scrollIntoViewIfNeeded();
  await shoot(page, "own-effect");
  await page.goto(`${two.address}#step=promote`);
  await page.waitForSelector(".promote");
  await shoot(page, "promote");
  await two.stop();
  const rivals = await open(["drift.csv", "--machine", machine], place.path);
  await page.goto(rivals.address);
  await page.waitForSelector("[data-verdict]");
  await shoot(page, "ambiguous");
  await rivals.stop();
  const pump = await open(["pump.csv", "--machine", pumpMachine], place.path);
  await page.goto(`${pump.address}#step=compare`);
  await page.waitForSelector(".centre .plot canvas");
  await shoot(page, "states");
  await page.goto(`${pump.address}#step=check`);
  await page.waitForSelector(".machine .mark");
  await shoot(page, "states-check");
  for (const [step, there] of [["locate", ".heat .cell"], ["add", ".centre h1"], ["confirm", ".save"]]) {
    await page.goto(`${pump.address}#step=${step}`);
    await page.waitForSelector("[data-verdict]");
    await page.waitForSelector(there);
    await shoot(page, `states-${step}`);
  }
  await pump.stop();
  const cylinder = await open(["cylinder.csv", "--machine", cylinderMachine], place.path);
  for (const step of ["compare", "locate"]) {
    await page.goto(`${cylinder.address}#step=${step}`);
    await page.waitForSelector("[data-verdict]");
    await page.waitForSelector(".centre .plot canvas");
    await shoot(page, `loop-${step}`);
  }
  await cylinder.stop();
  const valve = await open(["new.csv", "worn.csv", "--machine", valveMachine], place.path);
  for (const [state, step, before] of [["valve-check", "check", ""], ["valve-compare", "compare", ""], ["valve-locate", "locate", ""], ["valve-two", "compare", "new.csv"]]) {
    await page.goto(`${valve.address}#step=${step}`);
    if (before) await page.selectOption("select[name=hold-out]", before);
    await page.waitForSelector(before ? "td strong" : "[data-verdict]");
    await page.waitForSelector(".centre .plot canvas");
    await shoot(page, state);
  }
  await valve.stop();
  const alone = await open(["pump.csv"], place.path);
  await page.goto(alone.address);
  await page.waitForSelector(".machine [data-mark=shaft_speed]");
  await shoot(page, "mapping-pump");
  await page.locator(".sizes").first().scrollIntoViewIfNeeded();
  await shoot(page, "mapping-sizes");
  await alone.stop();
  await context.close();
}

/** Those of the documents, docs/page.png and docs/watch.png. */
async function takeForDocuments() {
  const context = await chromium.newContext({ viewport: { width: 1220, height: 680 }, colorScheme: "light", locale: "en-US" });
  const page = await context.newPage();
  const work = await open(["leak.csv", "--machine", machine], place.path);
  await page.goto(`${work.address}#step=compare`);
  await page.waitForSelector(".ranking table");
  await page.waitForSelector(".plot canvas");
  await page.waitForTimeout(500);
  await page.screenshot({ path: join(out, "page.png") });
  await work.stop();
  const watched = await open(["--db", "press.db", "--machine", "press.toml"], place.path);
  await page.goto(`${watched.address}#view=trends&p=K,V0`);
  await page.waitForSelector(".trend-plot canvas");
  await page.waitForTimeout(500);
  await page.screenshot({ path: join(out, "watch.png") });
  await watched.stop();
  await context.close();
}

if (only !== "watch" && only !== "service") await takeForDocuments();
if (only !== "documents") {
  await take("wide-light", wide, "light", "en-US");
  await take("wide-dark", wide, "dark", "de-DE");
  await take("phone-light", phone, "light", "de-DE");
  await take("phone-dark", phone, "dark", "en-US");
}
await chromium.close();
place.remove();
console.log(out);
