// Watching a database in a real browser: node --test watch_test.mjs. HYDROSCOPE names the program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { copyFileSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { after, before, test } from "node:test";
import { assertAccessible, assertFits, assertLooksGood, endBrowser, pagesOf, recordTexts, sharedProgram, startBrowser, until, visitIn, visitServed } from "./browser_fixture.mjs";
import { addValveChecks, begin, copyHistory, makeBeginning, makeEpisodes, makeFleet, makeHistory, simulate } from "./history.mjs";
import { folder, run, serve } from "./program.mjs";

const place = folder();
const words = ["--db", "press.db", "--machine", "press.toml"];
const shared = sharedProgram(words, place.path);
const visit = (t, of = words, options) => (of === words ? shared.visit(t, options) : visitIn(place.path, t, of, options));
const json = (of) => JSON.parse(run([...of, "--json", "-"], place.path));

before(async () => {
  makeHistory(place.path);
  addValveChecks(place.path);
  makeBeginning(place.path);
  await startBrowser();
});
after(async () => {
  await shared.end();
  await endBrowser();
  place.remove();
});

/** A database of its own for a test that changes its journal. */
function copyOfHistory(name) {
  copyHistory(place.path, name);
  return ["--db", `${name}.db`, "--machine", "press.toml"];
}

test("the overview says what stands and what moved, and never green while nothing is judged", async (t) => {
  const { page, address } = await visit(t);
  await page.goto(address);
  await page.waitForSelector(".tile .health-M");
  assert.match(await page.locator(".tile .health").innerText(), /Maintenance required/);
  const leak = page.locator(".tile tr", { hasText: "Internal leakage past the piston seal" });
  assert.match(await leak.innerText(), /Internal leakage past the piston seal[^]*changed/);
  assert.match(await page.locator(".tile .facts-line").innerText(), /15\d strokes · last Mar 1, 2026/);
  // the newest values are those that `trends` prints
  const summary = json(["trends", "--db", "press.db"]).summary.find((s) => s.parameter === "K");
  const shown = parseFloat(await page.locator(".tile tr", { hasText: "bulk modulus" }).locator("td").first().innerText());
  const factor = 1e-5;  // bar, as `fit` prints it
  assert.ok(Math.abs(shown - summary.value * factor) < 0.01 * shown, `${shown} is ${summary.value} Pa`);
  // beside the leak the others are as they were
  const { machines: [{ parameters }] } = await (await fetch(`${address}api/v1/watch/overview`)).json();
  for (const { parameter, reference } of parameters)
    if (!reference.moved) assert.ok(Math.abs(reference.deviation) < 4 * reference.std, `${parameter} deviates by ${reference.deviation}, std ${reference.std}`);

  const learning = await visit(t, ["--db", "learning.db", "--machine", "press.toml"]);
  await learning.page.goto(learning.address);
  await learning.page.waitForSelector(".tile .health-C");
  assert.match(await learning.page.locator(".tile .health").innerText(), /Learning, [12]\d of 100/);
  assert.equal(await learning.page.locator(".health-good").count(), 0);
});

test("a trend is zoomed, kept in the address, and its CSV holds what `trends` holds", async (t) => {
  const { page, address } = await visit(t);
  await page.goto(`${address}#view=trends&p=K`);
  await page.waitForSelector(".trend-plot canvas");
  assert.match(await page.locator(".trends [role=status]").innerText(), /Strokes 0 to 15\d of 15\d · Mar 1, 2026.* – Mar 1, 2026/);
  assert.match(await page.locator("main").innerText(), /Drag to zoom, Ctrl and wheel/);
  const plot = await page.locator(".trend-plot .u-over").boundingBox();
  await page.mouse.move(plot.x + 0.02 * plot.width, plot.y + 100);
  assert.match(await page.locator(".readout").innerText(), /Mar 1, 2026.* · stroke \d+ · K.* \d/);
  // dragging zooms; the address then names the strokes, and brings the same picture back
  await page.selectOption("label:has-text('Over') select", "stroke");
  await page.waitForSelector(".trend-plot canvas");
  await page.mouse.move(plot.x + 0.5 * plot.width, plot.y + 100);
  await page.mouse.down();
  await page.mouse.move(plot.x + 0.75 * plot.width, plot.y + 100, { steps: 4 });
  await page.mouse.up();
  await until(page, () => /from=7\d&to=1\d\d/.test(location.hash));
  const status = async () => (await page.locator(".trends [role=status]").innerText()).replace(/ · Loading …$/, "");  // what is beside it
  await until(page, () => /Strokes 7\d to 1[^…]*$/.test(document.querySelector(".trends [role=status]").textContent));  // and nothing loads
  const zoomed = await status();
  const url = page.url();
  await page.focus(".trend-plot [role=application]");
  await page.keyboard.press("0");
  await until(page, () => /Strokes 0 to/.test(document.querySelector(".trends [role=status]").textContent));
  await page.goto(url);
  await until(page, () => /Strokes 7\d to 1[^…]*$/.test(document.querySelector(".trends [role=status]").textContent));  // and nothing loads
  assert.equal(await status(), zoomed);
  await page.keyboard.press("Tab");

  // several parameters, and what the oil temperature accounts for taken out
  await page.check("input[name=p-V0]");
  await until(page, () => document.querySelectorAll(".trend-plot canvas").length === 2);
  await page.check("text=without what the oil temperature accounts for");
  await until(page, () => location.hash.includes("comp=1"));
  await page.uncheck("input[name=p-V0]");

  const download = page.waitForEvent("download");
  await page.click("button:has-text('CSV')");
  const [head, ...rows] = readFileSync(await (await download).path(), "utf8").trim().split("\n").map((row) => row.split(","));
  const points = new Map(json(["trends", "--db", "press.db", "--parameter", "K"]).points.map((p) => [p.sequence, p]));
  const unit = { factor: 1e-5, offset: 0 };  // bar, whatever the report's unit is
  assert.ok(rows.every((row) => row[head.indexOf("unit")] === "bar"));
  assert.ok(rows.length > 30 && rows.length < 60, `${rows.length} strokes are looked at`);
  for (const row of rows) {
    const point = points.get(Number(row[head.indexOf("first_stroke")]));
    assert.ok(Math.abs(Number(row[head.indexOf("mean")]) - (point.value * unit.factor + unit.offset)) < 1e-6 * Math.abs(point.value * unit.factor));
    assert.equal(Number(row[head.indexOf("end_s")]), point.time_s);
  }
  const picture = page.waitForEvent("download");
  await page.click("button:has-text('PNG')");
  assert.equal(readFileSync(await (await picture).path()).subarray(1, 4).toString(), "PNG");

  await page.selectOption("label:has-text('Over') select", "oil");
  await page.waitForSelector(".trend-plot[role=img] canvas");
});

test("alarms, references, changes of the model and valve checks are marked in the trend and listed below, also those since the last stroke", async (t) => {
  const own = copyOfHistory("marks");
  const { page, address, served } = await visit(t, own);
  await page.addInitScript(recordTexts);
  await page.goto(`${address}#view=trends&p=K`);
  await page.waitForSelector(".marks li >> nth=3");
  const marks = await page.locator(".marks li").allInnerTexts();
  assert.match(marks[0], /V valve check refused · Mar 2, 2026, .* · since the last stroke · the controller refused/);
  assert.match(marks[1], /V valve check measured · Mar 1, 2026, .* · stroke 1\d\d · 16 frequencies/);
  assert.match(marks[2], /▲ alarm\s*Internal leakage past the piston seal · stroke 1\d\d/);
  assert.match(marks[3], /R reference learned · stroke 99 · reference 1 learned from 0 to 99/);
  await until(page, () => ["▲", "R", "V"].every((letter) => window.drawnTexts.has(letter)));
  assert.ok(!(await page.evaluate(() => window.drawnTexts.has("M"))), "one model so far");
  await page.goto(`${address}#view=trends&p=K&to=90`);
  await page.waitForSelector(".trends [role=status]:has-text('Strokes 0 to 89')");
  await until(page, () => document.querySelectorAll(".marks li").length === 0);

  // a model that somebody promotes is marked as soon as strokes are identified with it
  await served.stop();
  for (const part of ["", "_rules"]) copyFileSync(join(place.path, `press${part}.toml`), join(place.path, `better${part}.toml`));
  run(["model", "add", "internal_leakage", "late.csv", "--machine", "better.toml"], place.path);
  run(["model", "promote", "--machine", "better.toml", "--db", "marks.db", "--user", "anna", "--comment", "the seal leaks"], place.path);
  simulate(place.path, "later.csv", begin + 2_000, ["--seconds", "60", "--seed", "5", "--oil", "40:46", "--effect", "internal_leakage=3e-12"]);
  run(["replay", "later.csv", "--machine", "better.toml", "--db", "marks.db"], place.path);
  const again = await visit(t, ["--db", "marks.db", "--machine", "better.toml"]);
  await again.page.addInitScript(recordTexts);
  await again.page.goto(`${again.address}#view=trends&p=K&x=stroke`);
  await again.page.waitForSelector(".marks li:has-text('model version')");
  assert.match(await again.page.locator(".marks li", { hasText: "model version" }).innerText(), /M model\s.*version 2 · stroke 15\d · model version 2 after 1/);
  await until(again.page, () => window.drawnTexts.has("M"));
});

test("panning moves the picture frame by frame, asks ahead for what comes, and ends with the last stroke", async (t) => {
  const { page, address } = await visit(t);
  await page.goto(`${address}#view=trends&p=K&x=stroke&from=20&to=40`);
  await page.waitForSelector(".trend-plot canvas");
  await until(page, () => /Strokes 20 to 39/.test(document.querySelector(".trends [role=status]").textContent));
  const asked = [];
  page.on("request", (request) => { if (/watch\/trend/.test(request.url())) asked.push(Number(new URL(request.url()).searchParams.get("end"))); });
  const turn = (pixels, turns) => page.evaluate(async ({ pixels, turns }) => {
    const over = document.querySelector(".trend-plot .u-over"), { left, width, top } = over.getBoundingClientRect();
    for (let k = 0; k < turns; ++k) {
      over.dispatchEvent(new WheelEvent("wheel", { shiftKey: true, deltaY: pixels, bubbles: true, cancelable: true, clientX: left + width / 2, clientY: top + 20 }));
      await new Promise(requestAnimationFrame);
    }
  }, { pixels, turns });
  await turn(100, 30);
  await until(page, () => /from=[67]\d&/.test(location.hash));
  assert.ok(asked.length > 2 && asked[0] > 60, `values were asked for before they were in view: ${asked}`);
  const picture = (of) => of.evaluate(() => document.querySelector(".trend-plot canvas").toDataURL());
  const atRest = async (of) => {
    for (let before = "", now = await picture(of); before !== now; now = await picture(of)) { before = now; await of.waitForTimeout(400); }
    return picture(of);
  };
  await page.mouse.move(5, 5);
  const panned = await atRest(page);
  const fresh = await page.context().newPage();
  await fresh.goto(page.url());
  await fresh.waitForSelector(".trend-plot canvas");
  assert.ok(panned === await atRest(fresh), "the picture that was moved is that of the same strokes looked at anew");
  await fresh.close();
  await turn(100, 150);
  await until(page, () => /from=1\d\d/.test(location.hash) && !/to=/.test(location.hash));
});

test("an alarm is read, leads to its strokes, is acknowledged, shelved and remarked", async (t) => {
  const own = copyOfHistory("acknowledged");
  const { page, address } = await visit(t, own);
  await page.addInitScript(recordTexts);
  await page.goto(address);
  await page.waitForSelector(".tile");
  await page.click(".views button:has-text('Alarms')");
  await page.click("[data-alarm='die_cushion/internal_leakage']");
  const detail = page.locator(".detail");
  assert.equal(await detail.locator("h2").innerText(), "More oil lost under pressure");
  assert.match(await detail.locator("dd", { hasText: "since stroke" }).innerText(), /^since stroke 1\d\d: Internal leakage past the piston seal \+0\.01\d+\s±\s[\d.]+\sl\/min per bar/);
  assert.match(await detail.locator("dd strong").innerText(), /^The cause is not proven: no repair yet\. To tell “Internal leakage past the piston seal” from /);
  assert.equal(await detail.locator("div:has(> dt:text-is('Cause')) dd").innerText(),
    "not proven; nearest: “Internal leakage past the piston seal”, “Leakage of the valve from the supply into chamber A”");
  assert.ok(await detail.locator("button:has-text('Shelve')").isDisabled(), "a shelf needs a reason");

  await page.fill("input[name=who]", "anna");
  await page.fill("textarea", "seal ordered");
  await page.click("button:has-text('Acknowledge')");
  await page.waitForSelector(".detail[data-state=ACKED]");
  assert.deepEqual(json(["alarms", ...own.slice(0, 2), "list"]).alarms.map((a) => a.state), ["ACKED"], "the command line sees it");
  await page.fill("textarea", "until the seal comes");
  await page.click("button:has-text('Shelve')");
  await page.waitForSelector(".detail[data-state=SHLVD]");
  await page.click("button:has-text('Take from the shelf')");
  await page.waitForSelector(".detail[data-state=ACKED]");
  await page.fill("textarea", "seal is here");
  await page.click("button:has-text('Only the remark')");
  await page.waitForSelector(".journal li:has-text('seal is here')");
  const journal = json(["alarms", ...own.slice(0, 2), "journal"]).journal.filter((row) => row.user === "anna");
  assert.deepEqual(journal.map((row) => [row.event, row.comment]),
    [["acknowledged", "seal ordered"], ["shelved", "until the seal comes"], ["unshelved", ""], ["commented", "seal is here"]]);

  await page.emulateMedia({ media: "print" });
  assert.ok(await page.locator(".work-order .done").isVisible(), "the work order has a place to sign");
  assert.match(await page.locator(".work-order .print-only").first().innerText(), /machine die_cushion, database \w+\.db/);
  assert.ok(!(await page.locator(".act").isVisible()));
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  await until(page, () => document.documentElement.dataset.theme === "dark");
  assert.equal(await page.locator(".work-order").evaluate((order) => getComputedStyle(order).backgroundColor), "rgb(255, 255, 255)", "paper is white");
  assert.equal(await pagesOf(page), 1, "a work order is one sheet");
  await page.emulateMedia({ colorScheme: "light" });
  await page.emulateMedia({ media: "screen" });
  await page.click("button:has-text('in the workbench')");
  await page.waitForSelector(".scrubber");  // the log that was replayed lies where it lay
  assert.match(await page.locator("header .what").innerText(), /die_cushion · die_cushion \d+–\d+/);
  await page.goto(`${address}#view=workbench&step=check`);
  await page.waitForSelector(".log-view canvas");
  assert.ok(await page.evaluate(() => [...window.drawnTexts].some((text) => /^time since Mar 1, 2026.*:\d\d.* \(s\)$/.test(text))), "a log that counts from 1970 is drawn from its first row on");
  await page.goBack();
  await page.goBack();
  await page.click("button:has-text('in the trend')");
  await page.waitForSelector(".trend-plot canvas");
  assert.match(await page.locator(".marks").innerText(), /▲ alarm Internal leakage past the piston seal/);
});

test("a German page tells the alarm in German: finding, evidence and what to do, of the alarm and of its health", async (t) => {
  const { page, address } = await visit(t, words, { locale: "de-DE" });
  await page.goto(address);
  await page.waitForSelector(".tile .health-M");
  assert.match(await page.locator(".tile .health").innerText(), /Mehr Öl geht unter Druck verloren \(Warnung\)/);
  await page.goto(`${address}#view=alarms&alarm=die_cushion/internal_leakage`);
  const detail = page.locator(".detail");
  assert.equal(await detail.locator("h2").innerText(), "Mehr Öl geht unter Druck verloren");
  assert.match(await detail.locator("dd", { hasText: "seit Hub" }).innerText(), /^seit Hub 1\d\d.*: Innere Leckage an der Kolbendichtung \+0,01\d+\s±\s[\d,]+\sl\/min je bar.*Hübe \d+ bis \d+ gegen \d+ bis \d+: am nächsten kommt: „Innere Leckage an der Kolbendichtung“ \(G = [\d,]+\s±\s[\d,]+\sl\/min je bar\).*nicht bewiesen: „Leckage des Ventils/s);
  assert.match(await detail.locator("dd strong").innerText(), /^Die Ursache ist nicht bewiesen: noch keine Reparatur\. Um „Innere Leckage an der Kolbendichtung“ von /);
  assert.equal(await detail.locator("[lang=en]:not(.journal *)").count(), 0, "nothing of the alarm is left in English");
  await page.selectOption("header select >> nth=-1", "en");
  await page.waitForSelector(".detail h2:has-text('More oil lost under pressure')");
});

test("twelve axes are seen at once: how many are how, the gravest first, parameters folded", async (t) => {
  makeFleet(place.path);
  const { page, address } = await visit(t, ["--db", "fleet.db"]);
  await page.goto(address);
  await page.waitForSelector(".tile .standing >> nth=8");
  assert.equal(await page.locator(".tile").count(), 12);
  assert.match(await page.locator(".glance").innerText(), /^C\s+12 Function check$/);
  assert.ok(await page.evaluate(() => document.documentElement.scrollHeight) < 1600, "a screen and a half");
  const alarms = (await page.locator(".tile").evaluateAll((tiles) => tiles.map((tile) => tile.getAttribute("aria-label"))));
  assert.deepEqual(alarms.slice(0, 3), ["Presse_Nord/Kissen_4", "Presse_Sued_mit_langem_Namen/Kissen_4", "P3/Kissen_4"], "with severity alarm");
  assert.match(await page.locator(".tile .standing").first().innerText(), /^alarm More oil lost under pressure$/);
  assert.equal(await page.locator(".tile .cards:visible").count(), 0);
  await page.click(".tile summary:has-text('Parameters') >> nth=0");
  await page.waitForSelector(".tile .cards:visible");
  await page.goto(`${address}#view=alarms&sort=axis`);
  await page.waitForSelector(".alarm-table tbody tr >> nth=8");
  for (const [view, there] of [["overview", ".tile"], ["alarms", ".alarm-table"]]) {
    await page.goto(`${address}#view=${view}`);
    await page.waitForSelector(there);
    await assertLooksGood(page, `twelve axes, ${view}`);
  }
});

test("a machine that counts in episodes is told in episodes, in both languages", async (t) => {
  makeEpisodes(place.path);
  const { page, address } = await visit(t, ["--db", "tank.db", "--machine", "tank.toml"]);
  for (const [language, counted, strange] of [["en", "40 episodes", /[Ss]troke/], ["de", "40 Episoden", /\b(Hub|Hübe|Hüben|Hubs)\b/]]) {
    await page.goto(`${address}#view=overview`);
    await page.selectOption(".top select >> nth=-1", language);
    await page.waitForSelector(`.tile .facts-line:has-text('${counted}')`);
    for (const [view, there] of [["overview", ".tile"], ["trends", ".trend-plot canvas"], ["alarms", ".alarms"], ["learn", ".learn .trend-plot canvas"]]) {
      await page.goto(`${address}#view=${view}`);
      await page.waitForSelector(there);
      assert.doesNotMatch(await page.locator("main").innerText(), strange, view);
    }
  }
});

test("the head stands in one line on a laptop in German, and alarms and tags are cards on a phone", async (t) => {
  const laptop = await visit(t, words, { locale: "de-DE", viewport: { width: 1220, height: 800 } });
  await laptop.page.goto(laptop.address);
  await laptop.page.waitForSelector(".tile");
  const tops = await laptop.page.locator(".top > *:visible, .views button").evaluateAll((parts) => parts.filter((part) => !part.matches(".spring")).map((part) => part.getBoundingClientRect()).map((box) => box.top + box.height / 2));
  assert.ok(Math.max(...tops) - Math.min(...tops) < 10, tops.join(" "));
  const phone = await visit(t, words, { locale: "de-DE", viewport: { width: 390, height: 844 } });
  for (const [view, cells] of [["alarms", ".alarm-table tbody td:visible"], ["scada", ".tags tbody td:visible"]]) {
    await phone.page.goto(`${phone.address}#view=${view}`);
    await phone.page.waitForSelector(cells);
    const right = await phone.page.locator(cells).evaluateAll((all) => Math.max(...all.map((cell) => cell.getBoundingClientRect().right)));
    assert.ok(right <= 390, `${view} reaches to ${right}`);
  }
  // names and findings as long as German can make them stay within
  await phone.page.goto(`${phone.address}#view=overview`);
  await phone.page.waitForSelector(".tile .standing button");
  const long = await phone.page.evaluate(() => {
    const word = "Druckhalteventilleckageüberwachungsgrenzwertüberschreitung";
    for (const button of document.querySelectorAll(".tile .standing button")) button.textContent = word;
    return Math.max(...[...document.querySelectorAll(".tile .standing button")].map((button) => button.getBoundingClientRect().right));
  });
  assert.ok(long <= 390, `an alarm reaches to ${long}`);
  await phone.page.goto(`${phone.address}#view=scada`);
  await phone.page.waitForSelector(".filters select");
  const chosen = await phone.page.evaluate(() => {
    const field = document.querySelector(".filters select");
    field.options[0].textContent = "Ziehkissenhauptzylinder_links_hinten_Presswerk_Untertürkheim_2";
    return field.getBoundingClientRect().right;
  });
  assert.ok(chosen <= 390, `a choice reaches to ${chosen}`);
});

test("an alarm arrives while the page is open, is acknowledged there, and survives a restart", async (t) => {
  const own = ["--db", "arrives.db", "--machine", "press.toml"], replay = (log) => run(["replay", log, "--machine", "press.toml", "--db", "arrives.db"], place.path);
  replay("early.csv");
  const { page, address, served } = await visit(t, own);
  await page.goto(`${address}#view=alarms`);
  await page.waitForSelector("text=No alarm was ever raised.");
  replay("late.csv");
  await page.waitForSelector(".views button:has-text('Alarms'):has-text('1')");
  await page.click("[data-alarm='die_cushion/internal_leakage']");
  await page.fill("textarea", "seal ordered");
  await page.click(".detail button:has-text('Acknowledge')");
  await page.waitForSelector(".detail[data-state=ACKED]");
  await served.stop();
  const again = await visit(t, own);
  await again.page.goto(`${again.address}#view=alarms&alarm=die_cushion/internal_leakage`);
  await again.page.waitForSelector(".detail[data-state=ACKED] .journal li:has-text('seal ordered')");
});

test("what happened is called as its alarm, in both languages, also where a rule raised it", async (t) => {
  const own = copyOfHistory("pilot");
  run(["replay", "late.csv", "--machine", "press.toml", "--db", "pilot.db"], place.path);  // judges the valve checks
  const { page, address } = await visit(t, own);
  await page.goto(`${address}#view=trends&p=K&x=stroke`);
  for (const [language, said] of [["en", "Valve slower: lower natural frequency"], ["de", "Ventil langsamer: kleinere Eigenfrequenz"]]) {
    await page.selectOption(".top select >> nth=-1", language);
    await page.waitForSelector(`.marks button:has-text("${said}")`);
    assert.doesNotMatch(await page.locator(".marks").innerText(), /slow_pilot_stage/);
  }
});

test("fingers are told what fingers can do", async (t) => {
  const { page, address } = await visit(t, words, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  for (const [view, said] of [["trends&p=K", /Tap to read values; the buttons/], ["learn", /Tap to read values; which strokes/]]) {
    await page.goto(`${address}#view=${view}`);
    await page.waitForSelector(".trend-plot canvas");
    assert.match(await page.locator("main").innerText(), said);
  }
});

test("an alarm that another program changes shows without loading anew", async (t) => {
  const own = copyOfHistory("elsewhere");
  const { page, address } = await visit(t, own);
  await page.goto(`${address}#view=alarms`);
  await page.waitForSelector(".state-UNACK");
  run(["alarms", ...own.slice(0, 2), "ack", "1", "--user", "bert"], place.path);
  await page.waitForSelector(".state-ACKED");
  await page.goto(`${address}#view=alarms&axis=die_cushion&severity=alarm`);
  await page.waitForSelector("text=No alarm stands that fits.");
});

test("the valve is shown over the years", async (t) => {
  const { page, address } = await visit(t);
  await page.goto(`${address}#view=valve`);
  await page.waitForSelector(".bode canvas");
  assert.equal(await page.locator(".valve canvas").count(), 3, "bandwidth, gain and phase");
  const rows = await page.locator(".valve tbody tr").allInnerTexts();
  assert.equal(rows.length, 17);
  assert.match(rows[0], /refused/);
  assert.match(rows[1], /measured\s+60\.9\s±\s2\.7\s+58\.0\s±\s1\.8/);
  assert.equal(await page.locator(".bode .legend span").count(), 6);
});

test("healthy strokes are chosen on the trend and learned; those with a leak are refused until one insists and says why", async (t) => {
  const own = copyOfHistory("learned");
  const { page, address } = await visit(t, own);
  await page.goto(`${address}#view=learn&from=112&to=150`);
  await page.waitForSelector(".learn .trend-plot canvas");
  assert.match(await page.locator("main").innerText(), /Drag to zoom, Ctrl and wheel/);
  await page.click("button[name=look]");
  await page.waitForSelector("[data-refused='1']");
  assert.match(await page.locator("[data-refused]").innerText(), /Internal leakage past the piston seal/);
  assert.ok(await page.locator("button[name=learn]").isDisabled());
  await page.check("input[name=insist]");
  assert.ok(await page.locator("button[name=learn]").isDisabled(), "who insists says why");

  await page.fill("input[name=learn-first]", "0");
  await page.evaluate(() => { location.hash = location.hash.replace("to=150", "to=140"); });  // draws the view anew
  await until(page, () => document.querySelector("input[name=learn-last]").value === "139");
  assert.equal(await page.inputValue("input[name=learn-first]"), "0", "what is typed stays");
  await page.keyboard.press("Tab");
  await until(page, () => !/from=/.test(location.hash) && document.querySelector("input[name=learn-first]").value === "0");
  await page.fill("input[name=learn-last]", "99");
  await page.keyboard.press("Tab");
  await until(page, () => /to=100/.test(location.hash) && !/from=/.test(location.hash));
  await page.click("button[name=look]");
  await page.waitForSelector("[data-refused='0']");
  await page.fill("input[name=who]", "anna");
  await page.fill("textarea[name=learn-comment]", "after the new seal");
  await page.click("button[name=learn]");
  await page.waitForSelector("[data-learned='2']");
  const row = json(["alarms", ...own.slice(0, 2), "journal"]).journal.filter((entry) => entry.event === "reference_learned").pop();
  assert.deepEqual([row.user, row.comment, row.first_stroke, row.last_stroke], ["anna", "after the new seal", 0, 99]);
  await page.waitForSelector(".learn .marks li >> nth=1");
});

test("without a service its view says how one is started, and sweeps cannot be asked for", async (t) => {
  const { page, address } = await visit(t);
  await page.goto(`${address}#view=service`);
  await page.waitForSelector(".service code:has-text('hydroscope serve')");
  await page.goto(`${address}#view=valve`);
  assert.ok(await page.locator("button[name=sweep]").isDisabled());
  const { token } = (await (await fetch(`${address}api/v1/session`)).json()).user;
  const asked = await fetch(`${address}api/v1/watch/valve_checks`, { method: "POST", headers: { "X-Hydroscope-Token": token }, body: '{"machine": "die_cushion"}' });
  assert.equal(asked.status, 400);
});

test("the tags are those of the feeds, and the CSV has what an engineer enters", async (t) => {
  const { page, address } = await visit(t);
  await page.goto(`${address}#view=scada&feed=modbus`);
  await page.waitForSelector(".tags tbody tr");
  const k = await page.locator(".tags tr", { hasText: "K, value" }).innerText();
  assert.match(k, /^modbus\s+1040\s+.*K, value.*float32\s+1\.\d+e\+09\s+Pa\s+x 1e-05 = bar/s);
  await page.goto(`${address}#view=scada`);
  await page.fill("input[type=search]", "Parameters/K");
  const download = page.waitForEvent("download");
  await page.click("button:has-text('CSV')");
  const [head, first] = readFileSync(await (await download).path(), "utf8").split("\n");
  assert.equal(head, "feed,axis,address,name,type,unit,scaling,meaning");
  assert.equal(first, "sparkplug,die_cushion,spBv1.0/hydroscope/DDATA/die_cushion/die_cushion,Parameters/K,Double,Pa,x 1e-05 = bar,");
});

test("what changes an alarm needs the token of the page, and reading says what is wrong with a question", async (t) => {
  const { address } = await visit(t);
  const body = JSON.stringify({ action: "acknowledge", machine: "die_cushion", alarm: "internal_leakage" });
  const post = (headers) => fetch(`${address}api/v1/watch/alarms`, { method: "POST", headers, body }).then((answer) => answer.status);
  assert.equal(await post({}), 403);
  assert.equal(await post({ "X-Hydroscope-Token": "0".repeat(64) }), 403);
  const { token } = (await (await fetch(`${address}api/v1/session`)).json()).user;
  assert.equal(await post({ "X-Hydroscope-Token": token, Origin: "http://evil.example" }), 403);
  const status = (path) => fetch(`${address}api/v1/watch/${path}`).then((answer) => answer.status);
  for (let k = 0; k < 100 && (await status("overview")) === 404; ++k) await new Promise((resolve) => setTimeout(resolve, 100));
  assert.equal(await status("overview"), 200);
  assert.equal(await status("trend?machine=die_cushion"), 400);
  assert.equal(await status("trend?machine=nobody&parameter=K"), 404);
  assert.equal(await status("trend?machine=die_cushion&parameter=K&first=-1"), 400);
  assert.equal(await status("trend?machine=die_cushion&parameter=K&first=9007199254740992&end=1"), 200);
  assert.equal(await status("stroke?machine=die_cushion&stroke=123456789"), 404);
  assert.equal(await status("nothing"), 404);
});

test("a service shows its database, and still answers its tools", async (t) => {
  const machine = fileURLToPath(new URL("../../machines/press_live.toml", import.meta.url));
  const served = await serve([machine, "--db", "served.db"], place.path);
  const { page, address } = await visitServed(served, t);
  assert.match(await (await fetch(`${address}metrics`)).text(), /^hydroscope_up|# HELP hydroscope_/m);
  assert.equal(JSON.parse(run(["status", "--db", "served.db", "--json", "-"], place.path)).database, "served.db", "by the socket");
  await page.goto(address);
  await page.waitForSelector(".tile .health-C, .tile .health-F");  // nothing comes, nothing is judged
  assert.equal(await page.locator(".health-good").count(), 0);
  assert.match(await page.locator(".overview").innerText(), /A service watches it/);
  assert.deepEqual(await page.locator(".views button").allInnerTexts(), ["Overview", "Trends", "Alarms", "Valve", "Learn", "SCADA", "Service", "Workbench"]);
  await page.goto(`${address}#view=service`);
  await page.waitForSelector(".service[data-state] table");
  assert.match(await page.locator(".service").innerText(), /Queues.*Disk\n(–|[\d.]+\s[MG]B) free.*Sources.*Channels/s);
  assert.match(await page.locator(".service").innerText(), /\d+ open files/);
  await assertAccessible(page, "service");
  await assertFits(page, "service");
  const post = (path, headers) => fetch(`${address}${path}`, { method: "POST", headers, body: "{}" }).then((answer) => answer.status);
  assert.equal(await post("api/v1/watch/alarms", {}), 401);
  assert.equal(await post("api/v1/watch/alarms", { "X-Hydroscope-Token": "" }), 401);
  assert.equal(await post("valve_check?axis=cushion_1", {}), 401);
  assert.deepEqual(await (await fetch(`${address}api/v1/session`)).json().then((session) => [session.workbench, session.changes]), [true, false]);
});

test("every view is accessible and fits, wide and on a phone, in both languages, light and dark, and keys reach all of it", async (t) => {
  const { page, address } = await visit(t);
  for (const [view, there] of [["overview", ".tile tbody tr"], ["trends", ".trend-plot canvas"], ["trends&x=oil", ".trend-plot canvas"], ["alarms&alarm=die_cushion/internal_leakage", ".journal li"], ["valve", ".bode canvas"], ["learn", ".trend-plot canvas"], ["service", ".service code"], ["scada&feed=dds", ".tags tbody tr"], ["workbench", ".drop"]]) {
    await page.goto(`${address}#view=${view}`);
    await page.waitForSelector(there);
    await assertLooksGood(page, view);
  }
});
