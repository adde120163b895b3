// The page in a real browser: node --test page_test.mjs. HYDROSCOPE names the program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { request } from "node:http";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { assertAccessible, assertLooksGood, dragThreshold, drop, endBrowser, errorsOfVersions, sharedProgram, startBrowser, until, visitIn } from "./browser_fixture.mjs";
import { folder, open, program, run } from "./program.mjs";

const machines = fileURLToPath(new URL("../../machines", import.meta.url));
const cushion = join(machines, "die_cushion.toml");
const place = folder();

before(async () => {
  await startBrowser();
  run(["simulate", "press", "--out", "hidden.csv", "--seconds", "90", "--seed", "4", "--effect", "relief_valve=3e-11"], place.path);
});
after(async () => {
  await hidden.end();
  await endBrowser();
  place.remove();
});

/** A page over these words of `open`, in the folder of the logs. */
const visit = (t, words, options) => visitIn(place.path, t, words, options);
const hidden = sharedProgram(["hidden.csv", "--machine", cushion], place.path);

test("a hidden effect is dropped, mapped, located, added and saved", async (t) => {
  const { page, address } = await visit(t, []);
  await page.goto(address);
  await drop(page, [join(place.path, "hidden.csv")]);

  // the proposal: everything is recognised, but for the area
  await page.waitForSelector(".pin.sure");
  assert.equal(await page.locator("#pin-p_A").inputValue(), "p_A");
  assert.equal(await page.locator(".columns .range").first().innerText(), "0 … 90", "from the first row to the last");
  assert.match(await page.locator(".columns").innerText(), /8\.77 … 227\sbar\n[^]*55 … 64\.7\sbar\n/, "in the unit of the sensor");
  await page.locator("#pin-p_0").selectOption("");
  await page.waitForSelector(".mark.free:has-text('p_0')");
  await page.locator("#pin-p_0").scrollIntoViewIfNeeded();  // the columns stay in sight
  await page.locator(".columns li", { hasText: "p_0" }).dragTo(page.locator(".pin", { has: page.locator("#pin-p_0") }));
  await until(page, () => document.querySelector("#pin-p_0").value === "p_0");
  await page.locator("#pin-p_B").selectOption("");
  await page.waitForSelector(".mark.free:has-text('p_B')");
  await page.locator(".mark", { hasText: "p_B" }).scrollIntoViewIfNeeded();
  await page.locator(".columns li", { hasText: "p_B" }).dragTo(page.locator(".mark", { hasText: "p_B" }));  // in the picture
  await until(page, () => document.querySelector("#pin-p_B").value === "p_B");
  assert.ok(await page.locator("button.primary").isDisabled(), "without the area there is no way on");
  await page.fill("input[name=A_A-bore]", "126.157");
  await page.waitForSelector(".verdict.good");
  await page.waitForSelector(".log-view canvas");
  assert.match(await page.locator(".log-view [role=status]").innerText(), /: 1\d strokes/);
  await page.click("button.primary");

  // compare: the error is above the noise, and the worst stroke comes first
  await page.click(".stepper button:has-text('Compare')");
  await page.waitForSelector(".scrubber");
  assert.match(await page.locator(".scrubber label span").innerText(), /1 of 1\d/);
  const firstStroke = Number((await page.locator(".scrubber label span").innerText()).match(/Stroke (\d+)/)[1]);
  await page.keyboard.press("Tab");
  await page.locator(".scrubber input").press("ArrowRight");
  await until(page, () => /2 of 1\d/.test(document.querySelector(".scrubber label span").textContent));

  // the failing region is read off the map: high pressure, where the relief valve opens early
  await page.click(".stepper button:has-text('Locate')");
  await page.locator(".heat select, label:has-text('Error over') select").first().selectOption({ label: (await page.locator("label:has-text('Error over') option").allInnerTexts()).find((name) => /^p_A \(/.test(name)) });
  const worst = page.locator(".cell.heat-5");
  await worst.first().waitFor();
  const region = await worst.first().getAttribute("title");
  assert.ok(Number(region.match(/^p_A ([\d.]+)/)[1]) > 170, region);
  await worst.first().click();
  await page.click("text=Show these rows in the strokes");
  await page.waitForSelector(".region");

  // the named effect: what it would do is shown, then it is added
  await page.click("[data-effect=relief_valve]");
  await page.waitForSelector("[data-preview]");
  const foretold = Number(await page.locator("[data-preview]").getAttribute("data-preview"));
  assert.equal(await page.locator(".staircase li").count(), 1, "looking changes nothing");
  await page.waitForSelector("[data-over=relief_valve] canvas");  // what it would change over the worst stroke
  assert.match(await page.locator("[data-over] figcaption").first().innerText(), /\+ Relief valve.*version 1/s);
  const { per_stroke: strokes } = await (await fetch(`${address}api/v1/results?kind=compare&version=1`)).json();
  const most = (size) => strokes.reduce((best, stroke) => (size(stroke) > size(best) ? stroke : best)).stroke;
  const telling = most((stroke) => stroke.windows * stroke.rms_residual ** 2);  // a short one has its noise only
  assert.match(await page.locator("[data-over] h3").innerText(), new RegExp(`over stroke ${telling}$`));
  assert.equal(firstStroke, most((stroke) => stroke.rms_residual ** 2 - stroke.noise_floor ** 2), "the worst of what noise does not explain comes first");
  await page.click("[data-add=relief_valve]");
  await page.waitForSelector("[data-error]");
  assert.equal(Number(await page.locator("[data-error]").getAttribute("data-error")), foretold);
  await page.waitForSelector("[data-verdict=adequate]");
  const [base, added] = await errorsOfVersions(page);
  const noise = parseFloat((await page.locator(".noise-key").innerText()).match(/: ([\d.]+)/)[1]);
  assert.ok(parseFloat(base) > 1.15 * noise, `${base} of the base model is far above the noise ${noise}`);
  assert.ok(parseFloat(added) < 1.05 * noise, `${added} with the effect is near the noise ${noise}`);

  // both versions of a stroke side by side
  await page.waitForSelector(".version-pair canvas");
  assert.equal(await page.locator(".version-pair canvas").count(), 2, "what they predict, and what they leave");

  // saved, and then used at the command line
  await page.fill("input[name=file]", "found.toml");
  await page.click(".save button.primary");
  await page.waitForSelector("[data-saved]");
  const fit = JSON.parse(run(["fit", "hidden.csv", "--machine", "found.toml", "--json", "-"], place.path));
  assert.ok(fit.parameters["relief_valve.G"].value > 2.5e-11 && fit.parameters["relief_valve.G"].value < 3.5e-11);

  // going back keeps the version gone back from
  await page.click("text=Go back to this version");
  await until(page, () => document.querySelectorAll(".staircase li")[0].classList.contains("current"));
  assert.equal(await page.locator(".staircase li").count(), 2);
});

test("a region drawn on the map filters strokes, overlay and ranking", async (t) => {
  const { page, address } = await hidden.visit(t);
  await page.goto(`${address}#step=locate`);
  await page.waitForSelector(".ranking table");
  await page.locator("label:has-text('Error over') select").selectOption({ label: (await page.locator("label:has-text('Error over') option").allInnerTexts()).find((name) => /^p_A \(/.test(name)) });
  const cells = page.locator(".cell"), count = await cells.count();
  const everything = (await page.locator(".ranking tbody tr").first().innerText()).trim();
  // the two cells of the highest pressure, by drawing over them
  const byPressure = (await cells.evaluateAll((all) => all.map((cell, k) => [parseFloat(cell.title.split(" ")[1]), k]))).sort((a, b) => b[0] - a[0]).map(([, k]) => k);
  const middleOf = async (k) => { const box = await cells.nth(k).boundingBox(); return [box.x + box.width / 2, box.y + box.height / 2]; };
  await page.mouse.move(...await middleOf(byPressure[1]));
  await page.mouse.down();
  await page.mouse.move(...await middleOf(byPressure[0]), { steps: 4 });
  await page.mouse.up();
  await page.waitForSelector("[data-region]:has-text('There the model errs by')");
  assert.equal(await page.locator(".cell[aria-pressed=true]").count(), 2);
  await page.waitForSelector("[data-ranked-there]");
  const ranked = await page.locator(".ranking tbody tr").first().innerText();
  assert.match(ranked, /Relief valve/);
  assert.notEqual(ranked.trim(), everything, "the error there is another one than that of all strokes");

  // the same by the keyboard: Shift and Enter chooses all from the cell chosen last
  const region = await page.evaluate(() => new URLSearchParams(location.hash.slice(1)).get("region"));
  await page.click("button:has-text('Show everything')");
  await cells.nth(byPressure[1]).focus();
  await page.keyboard.press("Enter");
  await until(page, () => document.querySelectorAll(".cell[aria-pressed=true]").length === 1);
  await cells.nth(byPressure[0]).focus();
  await page.keyboard.press("Shift+Enter");
  await until(page, () => document.querySelectorAll(".cell[aria-pressed=true]").length === 2);
  assert.equal(await page.evaluate(() => new URLSearchParams(location.hash.slice(1)).get("region")), region);
  assert.ok(count > 2);

  // the strokes listed are those with windows there, the worst there first; errors are of these windows alone
  const errors = await (await fetch(`${address}api/v1/region?where=${encodeURIComponent(region)}`)).json();
  const all = await (await fetch(`${address}api/v1/region?where=`)).json();
  assert.ok(errors.windows < all.windows && errors.rms > all.rms && errors.strokes.length <= all.strokes.length);
  assert.equal(errors.effects[0].effect, "relief_valve");
  assert.ok(errors.effects[0].rms < 1.1 * errors.noise, `${errors.effects[0].rms} is near the noise ${errors.noise}`);
  await page.click("text=Show these rows in the strokes");
  await page.waitForSelector(".centre .plot canvas");
  const energy = ({ windows, rms, noise }) => windows * (rms ** 2 - noise ** 2);  // one window says little of a stroke
  const worst = [...errors.strokes].sort((a, b) => energy(b) - energy(a))[0];
  assert.match(await page.locator(".scrubber label span").innerText(), new RegExp(`Stroke ${worst.stroke} .* 1 of ${errors.strokes.length} `));
  assert.match(await page.locator(".plot figcaption").first().innerText(), /measured elsewhere/);
  assert.equal((await fetch(`${address}api/v1/region?where=nothing:1:2`)).status, 400);
});

test("an effect that another one explains better is replaced by a button, and no version is lost", async (t) => {
  run(["simulate", "press", "--out", "leak.csv", "--seconds", "60", "--seed", "4", "--effect", "internal_leakage=4e-12"], place.path);
  writeFileSync(join(place.path, "wrong.toml"), readFileSync(cushion, "utf8").replace("[machine]\n", '[machine]\neffects = ["external_leakage"]\n'));
  const { page, address } = await visit(t, ["leak.csv", "--machine", "wrong.toml"]);
  await page.goto(address);
  await page.waitForSelector("[data-swap=external_leakage]");
  assert.match(await page.locator(".suspect", { has: page.locator("[data-swap]") }).innerText(), /Replace External leakage of chamber A by Internal leakage past the piston seal: error 0\.\d+\sl\/min → 0\.\d+\sl\/min/);
  const told = await page.locator(".verdict-panel").evaluate((panel) => [...panel.querySelectorAll("p")].map((p) => p.textContent).join("\n"));
  assert.match(told, /nearest relative: Orifice-like leakage from A to B(\n|$)/, "named once");
  assert.doesNotMatch(told, /->/);
  await page.click("[data-swap]");
  await until(page, () => /\+ Internal leakage past the piston seal/.test(document.querySelector(".staircase .current").textContent));
  assert.deepEqual((await page.locator(".staircase .head").allInnerTexts()).map((text) => text.replace(/\s+/g, " ")),
    ["1 + External leakage of chamber A", "2 base model", "3 + Internal leakage past the piston seal"]);
});

test("another step, and an effect chosen from further down, are seen from their top", async (t) => {
  const { page, address } = await hidden.visit(t, { viewport: { width: 390, height: 700 } });
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector(".ranking table");
  const down = () => page.evaluate(() => { scrollTo(0, 1e6); return scrollY; });
  for (const [press, step] of [[".stepper button:has-text('Locate')", "locate"], [".ranking tbody button >> nth=1", "add"], [".ranking tbody button >> nth=2", "add"]]) {
    assert.ok(await down() > 700);
    await page.locator(press).click();
    await until(page, "scrollY === 0");
    assert.match(page.url(), new RegExp(`step=${step}`));
  }
});

test("a threshold of the gate is dragged with a finger, and the strokes are counted anew", async (t) => {  // with the mouse: kinds_test.mjs
  const { page, address } = await visit(t, [], { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await page.goto(address);
  await page.setInputFiles("input[type=file]", join(place.path, "hidden.csv"));
  await page.waitForSelector(".pin.sure");
  assert.match(await page.locator(".mapping").innerText(), /Choose the column of each sensor/, "fingers do not drag columns");
  await page.fill("input[name=A_A-bore]", "126.157");
  const plot = page.locator(".gate-plot").first();
  await plot.locator("canvas").waitFor();
  await plot.scrollIntoViewIfNeeded();
  const bound = await plot.getAttribute("data-bound");
  const field = page.getByLabel(`${bound} from`), other = page.getByLabel(`${bound} to`);
  const before = [await field.inputValue(), await other.inputValue()];
  const counted = await page.locator(".log-view [role=status]").innerText();
  await dragThreshold(page, plot, true);
  await until(page, `JSON.stringify([${JSON.stringify(`${bound} from`)}, ${JSON.stringify(`${bound} to`)}].map((name) => document.querySelector(\`[aria-label="\${name}"]\`).value)) !== ${JSON.stringify(JSON.stringify(before))}`);
  await until(page, `document.querySelector(".log-view [role=status]").textContent !== ${JSON.stringify(counted)}`);
});

test("what a test off the log gave tells rivals apart, and can be forgotten", async (t) => {
  run(["simulate", "press", "--out", "rivals.csv", "--seconds", "60", "--seed", "2", "--effect", "pressure_offset"], place.path);
  const { page, address } = await visit(t, ["rivals.csv", "--machine", cushion]);
  await page.goto(`${address}#step=compare`);
  await page.waitForSelector("[data-verdict=ambiguous]");
  await page.waitForSelector(".experiment button:has-text('Add logs')");  // where it is said what to record
  await page.click(".measured summary");
  await page.selectOption("select[name=measured-effect]", "tank_pressure");
  await page.fill("input[name=measured-size]", "0");
  await page.fill("input[name=measured-std]", "0");
  await page.click(".measured button:has-text('Take it into account')");
  await page.waitForSelector(".measured .problem:has-text('above 0')");
  await page.fill("input[name=measured-std]", "0,1");
  await page.click(".measured button:has-text('Take it into account')");
  await page.waitForSelector("[data-verdict=named]");
  await page.waitForSelector(".suspect [data-effect=pressure_offset]");
  assert.equal(await page.locator(".suspect").count(), 1);
  assert.match(await page.locator(".measured li").innerText(), /Tank line.*: 0\s±\s0\.1\sbar/);
  await assertAccessible(page, "measured");
  await page.click(".measured button:has-text('Forget')");
  await page.waitForSelector("[data-verdict=ambiguous]");
});

test("the menu of units closes with every step that one goes to", async (t) => {
  const { page, address } = await hidden.visit(t);
  await page.goto(`${address}#step=check`);
  await page.waitForSelector("[data-verdict]");
  for (const step of ["locate", "check"]) {
    for (const go of [() => page.goto(`${address}#step=${step}`), () => page.click(`.stepper li:nth-child(2) button`)]) {
      await page.click(".unit-menu summary");
      await page.waitForSelector(".unit-menu[open] select");
      await go();
      await page.waitForSelector(".unit-menu:not([open])");
    }
  }
});

test("units are those that the reader chose, everywhere, and are remembered", async (t) => {
  const { page, address } = await hidden.visit(t);
  await page.goto(`${address}#step=locate`);
  await page.waitForSelector(".ranking table");
  await page.waitForSelector(".cell");
  const error = () => page.locator(".staircase .error").first().innerText();
  const flow = parseFloat(await error());
  assert.match(await error(), /\u202fl\/min$/, "no line breaks between a number and its unit");
  await page.click(".unit-menu summary");
  await page.selectOption("select[name=unit-flow]", "cm³/s");
  await page.selectOption("select[name=unit-pressure]", "MPa");
  assert.match(await error(), /\scm³\/s$/);
  assert.ok(Math.abs(parseFloat(await error()) - (flow * 1000) / 60) < 0.01 * flow * 17);
  await page.goto(`${address}#step=check`);
  await page.reload();
  await page.waitForSelector(".ranking table");
  await page.waitForSelector(".centre table");
  assert.match(await error(), /\scm³\/s$/);
  assert.match(await page.locator(".centre tr", { hasText: "p_A" }).first().innerText(), /MPa/);
  assert.match(await page.locator(".centre tr", { hasText: "Q_vn" }).first().innerText(), /cm³\/s/);
  assert.match(await page.locator(".centre tr", { hasText: "y_0" }).innerText(), /spool null.*%\sof\sstroke/s);  // as trends and reports have it
  const effects = await page.locator(".ranking tbody").innerText();
  assert.match(effects, /cm³\/s\sper\sMPa/);
  assert.doesNotMatch(effects, /l\/min|bar/);
});

test("a log and machine file of the command line; saving keeps the version before", async (t) => {
  writeFileSync(join(place.path, "press.toml"), readFileSync(cushion));
  const { page, address } = await visit(t, ["hidden.csv", "--machine", "press.toml"]);
  for (const effect of ["entrained_air", "periodic_disturbance"]) {
    await page.goto(`${address}#step=add&effect=${effect}`);
    await page.waitForSelector(`.centre .formula math`);  // drawn, not written
  }
  await page.goto(`${address}#step=add&effect=relief_valve`);
  await page.click("[data-add=relief_valve]:not([disabled])");
  await page.waitForSelector("[data-error]");
  assert.deepEqual(readFileSync(join(place.path, "press.toml")), readFileSync(cushion), "nothing is written before saving");
  await page.click(".save button.primary");
  await page.waitForSelector("[data-saved]");
  assert.match(readFileSync(join(place.path, "press.toml"), "utf8"), /effects = \["relief_valve"\]/);
  assert.deepEqual(readFileSync(join(place.path, "press.v1.toml")), readFileSync(cushion));
});

/** Status of a request with these headers, as other programs and pages could send it. */
function status(address, method, path, headers, body = "") {
  return new Promise((resolve, reject) => {
    const sent = request(new URL(path, address), { method, headers }, (answer) => { answer.resume(); resolve(answer.statusCode); });
    sent.on("error", reject);
    sent.end(body);
  });
}

test("other hosts, other sites and requests without the token are refused", async (t) => {
  const { address } = await visit(t, []);
  assert.equal(await status(address, "GET", "/", {}), 200);
  assert.equal(await status(address, "GET", "/", { Host: "evil.example" }), 421);
  assert.equal(await status(address, "GET", "/api/v1/session", { "Sec-Fetch-Site": "cross-site" }), 403);
  assert.equal(await status(address, "POST", "/api/v1/start_over", {}, "{}"), 403);
  assert.equal(await status(address, "POST", "/api/v1/start_over", { "X-Hydroscope-Token": "0".repeat(64) }, "{}"), 403);
  const { token } = (await (await fetch(`${address}api/v1/session`)).json()).user;
  assert.match(token, /^[0-9a-f]{64}$/);
  const headers = { "X-Hydroscope-Token": token };
  assert.equal(await status(address, "POST", "/api/v1/start_over", headers, "{}"), 200);
  assert.equal(await status(address, "POST", "/api/v1/start_over", { ...headers, Origin: "http://evil.example" }, "{}"), 403);
  assert.equal(await status(address, "POST", "/api/v1/work", headers, "x".repeat(300_000)), 413);
  assert.equal(await status(address, "GET", "/%2e%2e/etc/passwd", {}), 404);
  const answer = await fetch(address);
  assert.match(answer.headers.get("content-security-policy"), /script-src 'self'/);
  assert.doesNotMatch(answer.headers.get("content-security-policy"), /unsafe/);
});

test("a port that is taken is not shared", async (t) => {
  const { address } = await visit(t, []);
  const second = spawnSync(program, ["open", "--port", new URL(address).port], { encoding: "utf8", timeout: 20_000 });
  assert.equal(second.status, 3, second.stderr);
  assert.match(second.stderr, /port \d+ on 127\.0\.0\.1 cannot be opened/);
});

test("every state is accessible and fits, wide and on a phone, in both languages, light and dark, and keys reach all of it", async (t) => {
  const { page, address } = await visit(t, []);
  await page.goto(address);
  await page.waitForSelector(".drop");
  assert.equal(await page.getAttribute("html", "lang"), "en");
  assert.match(await page.locator("h1").innerText(), /machine's model/);
  await assertLooksGood(page, "start");
  await page.locator(".examples button").first().click();
  await page.waitForSelector(".pin.sure");
  await page.waitForSelector("p.verdict.good");  // an example tells its sizes: nobody else knows them
  await page.waitForSelector(".log-view canvas");
  await assertLooksGood(page, "mapping, ready");
  const bore = await page.inputValue("input[name=A_A-bore]");
  await page.fill("input[name=A_A-bore]", "");
  await page.waitForSelector("p.verdict.bad");
  await assertLooksGood(page, "mapping");
  await page.fill("input[name=A_A-bore]", bore);
  await page.waitForSelector("p.verdict.good");
  await page.locator("button.primary").click();
  await page.waitForSelector("[data-verdict=named]");
  for (const [step, there] of [["check", ".log-view canvas"], ["compare", ".plot canvas"], ["locate", ".cell"], ["add", "[data-preview]"], ["confirm", ".save"]]) {
    await page.goto(`${address}#step=${step}`);
    await page.waitForSelector(there);
    await assertLooksGood(page, step);
  }
  await page.click(".centre button:has-text('Add what is missing')");  // nothing was added: the way there
  await page.waitForSelector("[data-preview]");
  await page.setViewportSize({ width: 390, height: 844 });
  await page.click(".unit-menu summary");
  const menu = await page.locator(".unit-menu > div").boundingBox();
  assert.ok(menu.x >= 0 && menu.x + menu.width <= 390, `the units stand from ${menu.x} on, ${menu.width} wide`);
  await assertAccessible(page, "units");
});

test("the page says that the program is gone and finds it again, with what was typed", async (t) => {
  const first = await visit(t, []);
  const port = new URL(first.address).port;
  await first.page.goto(first.address);
  await first.page.setInputFiles("input[type=file]", join(place.path, "hidden.csv"));
  await first.page.waitForSelector(".pin.sure");
  await first.page.fill("input[name=A_A-bore]", "1");
  await first.served.stop();
  await first.page.waitForSelector(".lost");
  assert.equal(await first.page.inputValue("input[name=A_A-bore]"), "1");
  await first.page.fill("input[name=A_A-bore]", "12");
  await first.page.waitForSelector(".mapping .problem:has-text('The connection to the program is lost')");  // in words of the page
  const again = await open(["--port", port], place.path);
  t.after(() => again.stop());
  await first.page.waitForSelector(".lost", { state: "detached" });
  await first.page.setInputFiles("input[type=file]", join(place.path, "hidden.csv"));  // the token of the new program is fetched
  await first.page.waitForSelector(".pin.sure");
});
