// From a log alone to the model of a machine that is no cushion: its kind is recognised or chosen, its sizes are written.
// node --test kinds_test.mjs. HYDROSCOPE names the program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { assertAccessible, assertFits, dragThreshold, endBrowser, errorsOfVersions, startBrowser, until, visitIn } from "./browser_fixture.mjs";
import { folder, run } from "./program.mjs";
import { makeSpindle } from "./spindle.mjs";

const machines = fileURLToPath(new URL("../../machines", import.meta.url));
const place = folder();
const visit = (t, options) => visitIn(place.path, t, [], options);
const logs = { pump: ["--seconds", "1"], manipulator: ["--seconds", "20"], flexible_axis: ["--manoeuvre", "staircase"], test_cylinder: [] };

before(async () => {
  await startBrowser();
  for (const [kind, words] of Object.entries(logs)) run(["simulate", kind.replace("_", "-"), "--out", `${kind}.csv`, ...words], place.path);
});
after(async () => {
  await endBrowser();
  place.remove();
});

const dropped = async (page, log) => {
  await page.setInputFiles("input[type=file]", join(place.path, log));
  await page.waitForSelector(".mapping .pin");
};
const chosenKind = (page) => page.locator("select[name=kind]").inputValue();

/** Sizes of a machine file, as a person would copy them: name → text and unit. */
function sizesOf(machine) {
  const section = readFileSync(join(machines, `${machine}.toml`), "utf8").match(/\[geometry\]\n([^[]*)/)[1];
  return [...section.matchAll(/^(\w+)\s*=\s*\{ value = ([-\d.e]+), unit = "([^"]+)" \}/gm)].map(([, name, value, unit]) => ({ name, value: Number(value), unit }));
}

test("a log of each built-in machine is recognised, with its picture and every sensor that must be there", async (t) => {
  const { page, address } = await visit(t);
  page.on("dialog", (dialog) => void dialog.accept());
  await page.goto(address);
  for (const [kind, mark] of [["pump", "shaft_speed"], ["manipulator", "p_11"], ["flexible_axis", "pressure_1"], ["test_cylinder", "I_v"]]) {
    if (kind !== "pump") await page.click(".start-over");
    await page.waitForSelector(".drop");
    await dropped(page, `${kind}.csv`);
    assert.equal(await chosenKind(page), kind);
    await page.waitForSelector(`.machine [data-mark=${mark}]`);
    assert.equal(await page.locator(".pin.missing").count(), 0, kind);
  }
  await assertAccessible(page, "a machine that is no cushion");
});

test("a pump goes from its log alone to the workbench, and its file names what was written", async (t) => {
  const { page, address } = await visit(t);
  await page.goto(address);
  await dropped(page, "pump.csv");
  assert.match(await page.locator("p.verdict").innerText(), /Still missing: D_max .* and \d+ more/);
  const in_ = { mm: 1e-3, cm2: 1e-4, l: 1e-3, cm3: 1e-6, "cm³": 1e-6, bar: 1e5 };
  const areas = [];
  for (const { name, value, unit } of sizesOf("pump")) {
    if (unit === "cm2") { areas.push(name); await page.fill(`input[name=${name}-bore]`, String(20 * Math.sqrt(value / Math.PI))); continue; }
    const field = page.locator(`input[name=size-${name}]`);
    if (!(await field.isVisible())) await page.click("text=More sizes");
    const shown = (await page.locator(".size .entry", { has: field }).innerText()).trim();  // the unit that is asked for
    await field.fill(String((value * (in_[unit] ?? 1)) / (in_[shown] ?? 1)));
  }
  assert.deepEqual(areas, ["A_p", "A_v"]);
  await page.waitForSelector("p.verdict.good");
  const right = await page.inputValue("input[name=size-V_c]");
  await page.fill("input[name=size-V_c]", "1e9");
  await page.waitForSelector("p.verdict.bad:has-text('No machine has V_c')");
  assert.ok(await page.locator("button.primary").isDisabled());
  await page.fill("input[name=size-V_c]", right);
  await page.waitForSelector("p.verdict.good");
  await page.click("button.primary");
  await page.waitForSelector(".stepper");
  const text = await (await fetch(`${address}api/v1/machine`)).text();
  assert.match(text, /model = "pump"/);
  assert.match(text, /shaft = "shaft_speed"/);  // what is shown of it: own_models_test.mjs
});

test("the kind is chosen where columns say nothing; picture, sensors and words follow, and pins keep what they are given", async (t) => {
  const [head, ...rows] = readFileSync(join(place.path, "test_cylinder.csv"), "utf8").split("\n");
  assert.equal(head, "t,z_set,I_v,z");
  writeFileSync(join(place.path, "anonymous.csv"), ["t,AI_0,AI_1,AI_2", ...rows].join("\n"));
  const { page, address } = await visit(t, { locale: "de-DE", viewport: { width: 390, height: 844 } });
  await page.goto(address);
  await dropped(page, "anonymous.csv");
  assert.equal(await chosenKind(page), "expressions");
  let answer;
  await page.route("**/api/v1/proposal", (route) => { answer = () => route.continue(); });
  await page.selectOption("select[name=kind]", { label: "Prüfzylinder" });
  await page.waitForSelector(".mapping .empty");
  assert.equal(await page.locator(".pin, .machine, .balance, .verdict").count(), 0, "nothing is shown of the kind before");
  assert.equal(await chosenKind(page), "test_cylinder");
  await page.unroute("**/api/v1/proposal");
  await answer();
  await page.waitForSelector(".machine [data-mark=z_set]");
  assert.match(await page.locator(".kind").innerText(), /von Ihnen gewählt/);
  assert.equal(await page.locator(".pin.missing").count(), 3, "names that say nothing are not guessed at");
  await page.route("**/api/v1/proposal", async (route) => {  // answers come later than a quick hand chooses
    await new Promise((resolve) => setTimeout(resolve, 1000));
    await route.continue();
  });
  for (const [signal, column] of [["z_set", "AI_0"], ["I_v", "AI_1"], ["z", "AI_2"]]) await page.selectOption(`#pin-${signal}`, column);
  assert.ok(await page.locator("button.primary").isDisabled(), "nothing is accepted before its answer");
  await until(page, `document.querySelector("select[aria-label='Einheit z']")?.value === "mm"`);  // a rod of a test cylinder does not move by metres
  await page.unroute("**/api/v1/proposal");
  for (const [signal, column] of [["z_set", "AI_0"], ["I_v", "AI_1"], ["z", "AI_2"]]) assert.equal(await page.inputValue(`#pin-${signal}`), column);
  assert.equal(await chosenKind(page), "test_cylinder");
  await page.selectOption("#pin-z", "");
  await page.waitForSelector(".pin.missing");
  assert.equal(await chosenKind(page), "test_cylinder", "a pin that is emptied leaves the machine what it is");
  await page.selectOption("#pin-z", "AI_2");
  await page.fill("input[name=A-bore]", "40.69");
  await page.waitForSelector("p.verdict.good");
  await assertAccessible(page, "chosen kind");
  await assertFits(page, "chosen kind");
});

test("columns that say nothing are put right by hand: what was guessed of others stays a guess, scales stay, and the workbench leads back", async (t) => {
  run(["simulate", "press", "--out", "press.csv", "--seconds", "40", "--seed", "4"], place.path);
  const [head, ...rows] = readFileSync(join(place.path, "press.csv"), "utf8").trimEnd().split("\n");
  const at = Object.fromEntries(head.split(",").map((name, k) => [name, k]));
  const german = rows.map((row) => row.split(",").map(Number)).map((v) => [1000 * v[at.t], v[at.p_A] / 1e5, 1000 * v[at.z], v[at.U_v], 10 * v[at.y_v], v[at.p_0] / 1e5, v[at.T_oil]]
    .map((x, k) => x.toFixed(k === 0 ? 1 : 4).replace(".", ",")).join(";"));
  writeFileSync(join(place.path, "kissen.csv"), ["Zeit_ms;pA_bar;s_mm;AI_0;AI_1;p_Sys;T_oil", ...german].join("\n"));
  const { page, address } = await visit(t);
  await page.goto(address);
  await dropped(page, "kissen.csv");
  const row = (signal) => page.locator(".pin", { has: page.locator(`#pin-${signal}`) });
  const guess = await row("p_0").innerText();
  assert.equal(await page.inputValue("#pin-y_v"), "AI_1", "the spool follows its command");
  for (const [signal, column] of [["y_v", ""], ["U_v", ""], ["y_v", "AI_0"], ["U_v", "AI_1"]]) {
    await page.selectOption(`#pin-${signal}`, column);
    await until(page, `document.querySelector("#pin-${signal}").value === "${column}"`);
  }
  const widest = async (signal) => Math.max(...(await row(signal).locator(".says").innerText()).match(/-?[\d.]+/g).map(Number));
  await until(page, `/0\\.\\d+ … 0\\.\\d+/.test(document.querySelector("#pin-y_v").closest(".pin").querySelector(".says").textContent)`);
  await until(page, `/\\d … -?\\d/.test(document.querySelector("#pin-U_v").closest(".pin").querySelector(".says").textContent)`);
  assert.ok(await widest("y_v") < 1.2, await row("y_v").innerText());
  assert.ok(await widest("U_v") < 12, await row("U_v").innerText());
  assert.match(await row("y_v").innerText(), /put here by hand; values [^]*taken as volts/);
  assert.match(await row("p_A").innerText(), /unit in the name/, "and not in the header");
  assert.equal(await row("p_0").innerText(), guess, "what nobody touched is as sure as before");
  await page.selectOption("select[aria-label='Unit y_v']", "1");
  await page.waitForSelector(".pin.check:has-text('no opening of a spool')");
  assert.match(await row("y_v").innerText(), /unit chosen by hand/);
  await page.selectOption("select[aria-label='Unit y_v']", "V");
  await until(page, `!/no opening/.test(document.querySelector(".pins").textContent)`);
  await page.fill("input[name=A_A-bore]", "126.157");
  await page.waitForSelector("p.verdict.good");
  await page.click(".mapping > button.primary");
  await page.waitForSelector("[data-verdict]");

  await page.click("button:has-text('Columns and sizes')");
  await page.waitForSelector("p.verdict.good");
  assert.equal(await page.inputValue("#pin-y_v"), "AI_0");
  assert.equal(await page.inputValue("input[name=A_A-bore]"), "126.16");
  await page.reload();
  await page.waitForSelector("p.verdict.good");
  assert.equal(await page.inputValue("#pin-U_v"), "AI_1", "what was put by hand outlives the page");
});

test("a test cylinder is judged by its frequency response: what changed from the references of its file, and from an earlier log", async (t) => {
  for (const [name, words] of [["march", []], ["today", ["--valve", "38", "--seed", "2"]]]) run(["simulate", "test-cylinder", "--out", `${name}.csv`, "--seconds", "20", ...words], place.path);
  const { page, address } = await visitIn(place.path, t, ["march.csv", "today.csv", "--machine", join(machines, "test_cylinder.toml")]);
  const gain = async () => Number((await page.locator("[data-change=valve_gain]").innerText()).match(/Flow gain of the valve: ([\d.]+)\s±\s[\d.]+ times/i)[1]);
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector(".centre .plot canvas");
  await page.waitForSelector("[data-verdict=named]");
  assert.ok(Math.abs(await gain() - 2.017) < 0.1);
  await page.selectOption("select[name=hold-out]", "march.csv");
  await page.waitForSelector("text=Compared with: march.csv");
  await page.waitForSelector("[data-verdict=named]");
  assert.ok(Math.abs(await gain() - 2.014) < 0.1);
  const changes = await (await fetch(`${address}api/v1/results?kind=explain&version=1`)).json();
  assert.match(changes.text, /What changed from march.csv to today.csv[^]*named: valve_gain/, "as the command line prints it, without folders");
  await until(page, () => [...document.querySelectorAll(".centre td")].some((cell) => /^\+10[0-3]\s%$/.test(cell.textContent)));
  await assertAccessible(page, "closed loop, compare");
  for (const [step, there] of [["check", ".machine .mark"], ["locate", ".plot canvas"], ["add", ".centre h1"], ["confirm", ".centre tbody tr"], ["promote", ".promote"]]) {
    await page.goto(`${address}#step=${step}`);
    await page.waitForSelector(`.centre ${there.replace(".centre ", "")}`);
    assert.equal(await page.locator(".problem").count(), 0, step);
  }
});

test("the log of a sweep of a valve goes from its file alone to gain and phase with their model, and beside an earlier one", async (t) => {
  run(["simulate", "valve", "--out", "new.csv"], place.path);
  run(["simulate", "valve", "--out", "worn.csv", "--f0", "120", "--damping", "0.9", "--seed", "2"], place.path);
  const { page, address } = await visit(t);
  await page.goto(address);
  await dropped(page, "worn.csv");
  assert.equal(await chosenKind(page), "valve");
  await page.click("button.primary:has-text('To the workbench')");
  await page.waitForSelector("[data-verdict=adequate]");
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector(".centre .plot canvas");
  const frf = JSON.parse(run(["frf", "worn.csv", "-m", join(machines, "valve_sweep.toml"), "--json", "-"], place.path));
  const shown = async () => (await page.locator(".centre table").first().innerText()).replace(/\s+/g, " ");
  const figure = ({ value, std }, digits) => `${value.toFixed(digits)} ± ${(1.96 * std).toFixed(digits)}`;
  assert.ok((await shown()).includes(`natural frequency ${figure(frf.model.f0_hz, 3)} Hz`), await shown());
  assert.match(await page.locator(".verdict-panel").innerText(), /The gain is 3\sdB lower at [\d.]+\s±\s[\d.]+\sHz/);
  await page.setInputFiles("input.more-logs", join(place.path, "new.csv"));
  await page.selectOption("select[name=hold-out]", "new.csv");
  await page.waitForSelector(".centre td strong:has-text('-34')");  // from 183.9 to 120 Hz
  for (const [step, there] of [["check", ".machine .mark"], ["locate", ".plot canvas"], ["add", "h1"], ["confirm", "tbody tr"], ["promote", ".promote"]]) {
    await page.goto(`${address}#step=${step}`);
    await page.waitForSelector(`.centre ${there}`);
    assert.equal(await page.locator(".problem").count(), 0, step);
  }
  await page.goto(`${address}#step=compare`);
  await page.click("text=How it is measured");
  await page.fill("input[name=frf-to]", "100");
  await page.press("input[name=frf-to]", "Tab");
  await page.waitForSelector("text=/6 × outside the range asked for/");
  await assertAccessible(page, "two valves, options");

  const press = await visitIn(place.path, t, ["worn.csv", "--machine", join(machines, "die_cushion.toml")]);  // a press that has a valve
  await press.page.goto(`${press.address}#step=compare`);
  await press.page.click(".centre button:has-text('Response of the valve')");
  await press.page.waitForSelector(".centre .plot canvas");
  assert.match(await press.page.locator(".centre table").first().innerText(), /120\.\d/);
});

test("a balance of one's own is written over the columns of a log, checked, and worked on", async (t) => {
  let seed = 5;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647 - 0.5;
  const rows = Array.from({ length: 6000 }, (_, k) => {
    const time = k * 0.01, force = 2000 + 900 * Math.sin(time) + 500 * Math.sin(0.37 * time);
    return `${time.toFixed(2)},${(force + 4 * random()).toFixed(3)},${(force / 0.0005 / 1e5 + 0.002 * random()).toFixed(5)},${(40 + 9 * Math.sin(0.2 * time)).toFixed(3)}`;
  });
  writeFileSync(join(place.path, "jack.csv"), ["t,load [kN],jack pressure [bar],temp [degC]", ...rows].join("\n"));
  const { page, address } = await visit(t);
  await page.goto(address);
  await dropped(page, "jack.csv");
  await page.selectOption("select[name=kind]", { label: "machine with a balance of its own" });
  await page.waitForSelector(".balance");
  assert.deepEqual((await page.locator(".pin label strong").allInnerTexts()).sort(), ["T_oil", "jack_pressure", "load", "time"]);
  const oil = await page.locator(".pin", { hasText: "T_oil" }).locator("select").nth(1).innerText();
  assert.match(oil, /°C/);
  assert.doesNotMatch(oil, /degC/);
  const load = "load", pressure = "jack_pressure";
  await page.fill("input[name=balance-output]", load);
  await page.fill("input[name=balance-name-0]", "A");
  await page.fill("input[name=balance-expression-0]", `${pressure} + ${load}*0 + nothing`);
  await page.waitForSelector(".balance pre.problem");
  assert.match(await page.locator(".balance pre.problem").innerText(), /nothing/);
  assert.ok(await page.locator("button.primary").isDisabled());
  await page.fill("input[name=balance-expression-0]", pressure);
  await page.waitForSelector("p.verdict.good");
  await page.click("button.primary");
  await page.waitForSelector("[data-verdict]");
  assert.match((await errorsOfVersions(page))[0], /\skN$/);
  assert.match(await (await fetch(`${address}api/v1/machine`)).text(), /\[balance\][^]*A = /);
});

test("a winch goes from its log to the watch: the balance that is proposed is refined, what is missing added, and the better model promoted", async (t) => {
  let seed = 3;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647 - 0.5;
  const rows = Array.from({ length: 6000 }, (_, k) => {
    const time = 0.01 * k, turns = 60 * Math.sin(0.7 * time), bar = 110 + 40 * Math.sin(0.31 * time) + 15 * Math.sin(1.7 * time);
    return [time, 0.21 * bar - 0.9 * Math.sign(turns) + 0.02 * random(), bar + 0.05 * random(), turns + 0.1 * random()].map((value) => value.toFixed(3)).join(";").replaceAll(".", ",");
  });
  writeFileSync(join(place.path, "winde.csv"), ["Zeit_s;Seilkraft [kN];Motordruck [bar];Trommeldrehzahl [rpm]", ...rows].join("\n"));
  const { page, address, served } = await visit(t, { locale: "de-DE" });
  await page.goto(address);
  await dropped(page, "winde.csv");
  await page.click("button:has-text('Eigene Bilanz und Effekte schreiben')");
  await page.waitForSelector("p.verdict.good");
  const [force, pressure, speed] = await page.locator(".columns .role button").allInnerTexts();
  assert.deepEqual([await page.inputValue("input[name=balance-output]"), await page.inputValue("input[name=balance-expression-0]")], [force, pressure], "what was proposed is there to begin with");
  await page.click("button:has-text('Noch ein Effekt')");
  await page.fill("input[name=effect-id-0]", "trommelreibung");
  await page.fill("input[name=effect-expression-0]", `sign(${speed})`);
  await page.waitForSelector(".effects .law .plot canvas");
  const looked = page.waitForResponse((answer) => /api\/v1\/proposal/.test(answer.url()) && /"not_negative":false/.test(answer.request().postData()));
  await page.uncheck(".effects input[type=checkbox]");
  await looked;
  await page.waitForSelector("p.verdict.good");
  await page.click("button.primary:has-text('Zur Werkbank')");
  await page.waitForSelector("[data-verdict=named]");
  assert.match(await page.locator(".verdict-panel").innerText(), /Dem Modell fehlt[^]*trommelreibung/);
  await page.goto(`${address}#step=confirm`);
  await page.fill("input[name=file]", "winde.toml");
  await page.click(".save button.primary");
  await page.waitForSelector("[data-saved]");
  await served.leave();

  run(["replay", "winde.csv", "--machine", "winde.toml", "--db", "winde.db"], place.path);
  const watched = await visitIn(place.path, t, ["--db", "winde.db", "--machine", "winde.toml"], { locale: "de-DE" }), at = watched.page;
  await at.goto(`${watched.address}#view=trends`);
  await at.waitForSelector(".trend-plot canvas");
  await at.click("button:has-text('in der Werkbank öffnen')");
  await at.waitForSelector("[data-verdict=named]");
  await at.goto(`${watched.address}#view=workbench&step=add&effect=trommelreibung`);
  await at.click("[data-add=trommelreibung]:not([disabled])");
  await at.waitForSelector("[data-error]");
  await at.waitForSelector("[data-verdict=adequate]");
  const [base, added] = (await errorsOfVersions(at)).map((error) => parseFloat(error.replace(",", ".")));
  assert.ok(added < 0.2 * base, `the error falls from ${base} to ${added}`);
  await at.goto(`${watched.address}#view=workbench&step=promote`);
  await at.fill("textarea[name=promote-comment]", "die Trommel reibt");
  await at.click(".promote button.primary");
  await at.waitForSelector("[data-done]");
  const { journal } = JSON.parse(run(["alarms", "--db", "winde.db", "journal", "--json", "-"], place.path));
  assert.ok(journal.some((row) => row.event === "model_promoted" && row.comment === "die Trommel reibt"));
});

test("a machine of one's own is drawn by its signals", async (t) => {
  writeFileSync(join(place.path, "force.csv"), ["t,F,p_A,z"].concat(Array.from({ length: 400 }, (_, k) => `${k * 0.01},${1000 + 10 * Math.sin(k / 9)},${1e6 + 1e4 * Math.sin(k / 9)},${0.1 + 0.05 * Math.cos(k / 9)}`)).join("\n"));
  const { page, address } = await visit(t);
  await page.goto(address);
  await dropped(page, "force.csv");
  await page.waitForSelector(".machine [data-mark=p_A]");
  const side = (name) => page.locator(`[data-mark=${name}] rect`).evaluate((box) => Number(box.getAttribute("x")));
  assert.ok(await side("p_A") < await side("F"), "what is explained stands right");
});

test("a machine of one's own has a page of its own: from the first page and back, with what is wrong at its place, its terms over a stroke, and a verdict", async (t) => {
  makeSpindle(place.path);
  const { page, address } = await visit(t, { locale: "de-DE" });
  await page.goto(address);
  await page.click("button:has-text('Eigene Bilanz und Effekte schreiben')");
  await page.waitForSelector(".own-machine .balance");
  assert.match(page.url(), /page=own/);
  await page.fill("input[name=balance-name-0]", "flaeche");
  await page.click("button:has-text('Erste Seite')");
  await page.waitForSelector(".examples");
  await page.goBack();
  assert.equal(await page.inputValue("input[name=balance-name-0]"), "flaeche", "what was typed stays");
  await page.setInputFiles("input[type=file]", join(place.path, "spindel.csv"));
  await page.waitForSelector(".own-machine .pin");
  assert.equal(await page.inputValue("input[name=balance-name-0]"), "flaeche");
  const [force, pressure, way] = await page.locator(".columns .role button").allInnerTexts();
  await page.waitForSelector(".own-machine .gate-plot, .own-machine .log-view .plot canvas");
  await page.click("input[name=balance-output]");
  await page.click(`.columns button:has-text("${force}")`);
  assert.equal(await page.inputValue("input[name=balance-output]"), force, "a name is put where one writes");
  await page.fill("input[name=balance-expression-0]", `${pressure} + ${way}`);
  await page.waitForSelector(".balance pre.problem:has-text('^')");
  assert.match(await page.locator(".balance pre.problem").innerText(), /Pa[^]*m[^]*\n +\^/, "units do not fit, at the character");
  assert.ok(await page.locator("button.primary").isDisabled());
  assert.doesNotMatch(await page.locator("p.verdict").innerText(), /\^|\[/, "and below in words alone");
  await page.fill("input[name=balance-expression-0]", `2*${force} + ${pressure}`);
  await page.waitForSelector(".balance pre.problem:has-text('ist der Ausgang selbst und würde ihn ganz erklären')");
  assert.match(await page.locator(".balance pre.problem").innerText(), /\n {6}\^/, "at the character");
  await page.fill("input[name=balance-expression-0]", pressure);
  await page.waitForSelector(".terms .law .plot canvas");
  await page.click("button:has-text('Noch ein Effekt')");
  await page.fill("input[name=effect-id-0]", "reibung");
  await page.fill("input[name=effect-expression-0]", `sign(ddt(${way}))`);
  await page.waitForSelector(".effects .law .plot canvas");
  await page.uncheck(".effects input[type=checkbox]");
  await page.waitForSelector("p.verdict.good");

  // a line that nothing is written into yet keeps nothing back; one without a name is told
  await page.click("button:has-text('Noch ein Effekt')");
  await page.fill("input[name=balance-expression-0]", `${pressure} + ${way}`);
  await page.waitForSelector("p.verdict.bad:has-text('Pa')");
  await page.fill("input[name=balance-expression-0]", pressure);
  await page.waitForSelector("p.verdict.good");
  await page.fill("input[name=effect-expression-1]", way);
  await page.fill("input[name=effect-id-1]", "");
  await page.waitForSelector("p.verdict.bad:has-text('ein Name')");
  assert.ok(await page.locator("button.primary").isDisabled());
  await page.click(".effects li:nth-child(2) button");
  await page.waitForSelector("p.verdict.good");

  // the gate: a condition that is written is a line, which is dragged
  const strokes = () => page.locator(".log-view [role=status]").innerText();
  const all = await strokes();
  await page.selectOption("select[name=gate-signal]", way);
  await page.selectOption("select[name=gate-look]", "gateSpeed");
  await page.fill(`[aria-label='Geschwindigkeit von ${way} von']`, "1");
  await page.keyboard.press("Tab");
  const gate = page.locator(".gate-plot");
  await gate.locator("canvas").waitFor();
  const slow = await strokes();
  assert.notEqual(slow, all);
  await dragThreshold(page, gate);
  await until(page, `Number(document.querySelector("[aria-label='Geschwindigkeit von ${way} von']").value.replace(",", ".")) > 5`);
  await page.click(`[aria-label^='Herausnehmen: Geschwindigkeit']`);
  await gate.waitFor({ state: "detached" });
  await until(page, `document.querySelector(".log-view [role=status]").textContent === ${JSON.stringify(all)}`);

  // a unit of a column changes what is drawn, though the answer to what is written meanwhile overtakes that to it
  let release;
  const held = new Promise((go) => { release = go; });
  let requests = 0;
  await page.route("**/api/v1/proposal", async (route) => {
    if (++requests === 1) await held;
    await route.continue().catch(() => {});
  });
  const drawn = page.waitForRequest((request) => /api\/v1\/work$/.test(request.url()) && /picture/.test(request.postData() ?? ""));
  await page.selectOption(`select[aria-label='Einheit ${way}']`, "cm");
  await page.fill("input[name=effect-id-0]", "trockene_reibung");
  await until(page, "document.querySelector('p.verdict.good') !== null");
  await drawn;
  release();
  await page.unroute("**/api/v1/proposal");
  await page.fill("input[name=effect-id-0]", "reibung");
  await page.selectOption(`select[aria-label='Einheit ${way}']`, "mm");
  await page.waitForSelector("p.verdict.good");

  await page.click("button:has-text('Spalten und Sensoren')");
  await page.waitForSelector("select[name=kind]");
  await page.goBack();
  assert.equal(await page.inputValue("input[name=effect-expression-0]"), `sign(ddt(${way}))`);
  await page.reload();
  await page.waitForSelector("p.verdict.good");
  assert.equal(await page.inputValue("input[name=effect-id-0]"), "reibung", "loading anew takes nothing away");
  await page.waitForSelector(".effects .law .plot canvas");
  await assertAccessible(page, "own machine");
  await page.setViewportSize({ width: 390, height: 844 });
  await assertFits(page, "own machine on a phone");
  await page.setViewportSize({ width: 1400, height: 900 });
  await page.click("button.primary:has-text('Zur Werkbank')");
  await page.waitForSelector("[data-verdict]");
  assert.match(await page.locator(".verdict-panel").innerText(), /Dem Modell fehlt[^]*reibung/);
  assert.doesNotMatch(await page.locator(".verdict-panel").innerText(), /Wonach zu sehen ist/, "of an effect of one's own nobody has told it");
});
