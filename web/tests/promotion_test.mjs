// From a machine that is watched to a better model that it is watched with, in a real browser: node --test promotion_test.mjs.
// HYDROSCOPE names the program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { assertAccessible, assertFits, endBrowser, recordTexts, startBrowser, press as pressKey, tabTo, until, visitServed } from "./browser_fixture.mjs";
import { folder, program, run, serve } from "./program.mjs";

const place = folder();
const password = "long enough to guess";
const speed = 10;  // times real time
const enough = 20;  // strokes that show the leak, also on a machine with much to do
let press;

/** A press of one cylinder with a leak that its model does not know, on the wire. */
before(async () => {
  const text = readFileSync(fileURLToPath(new URL("../../machines/press_live.toml", import.meta.url)), "utf8")
    .replace(/axes = \[.*\]/, 'axes = ["cushion_1"]').replace("grid_period = { value = 1,", "grid_period = { value = 2,").replace("domain = 0", `domain = ${20 + (process.pid % 200)}`).replace("port = 1502", `port = ${41_000 + (process.pid % 9_000)}`);
  writeFileSync(join(place.path, "live.toml"), text);
  press = spawn(program, ["simulate", "press", "--serve", "live.toml", "--speed", String(speed), "--sample-period", "0.002", "--seed", "4", "--effect", "internal_leakage=4e-12"], { cwd: place.path, stdio: ["pipe", "ignore", "ignore"] });
  await startBrowser();
});
after(async () => {
  await endBrowser();
  press.kill("SIGTERM");
  place.remove();
});

/** Looks at the database until the condition holds; what was seen then. */
async function untilWatched(address, condition) {
  for (const end = Date.now() + 180_000; Date.now() < end; await new Promise((resolve) => setTimeout(resolve, 500))) {
    const answer = await fetch(`${address}api/v1/watch/overview`);
    if (!answer.ok) continue;
    const seen = (await answer.json()).machines?.[0];
    if (seen && condition(seen)) return seen;
  }
  return assert.fail(`not so after 180 s: ${condition}`);
}

test("a sweep of the valve is asked for; strokes of a trend go to the workbench, the effect that is missing is added and promoted, and the live monitor uses it", async (t) => {
  for (const role of ["operate", "admin"]) run(["users", "--db", "live.db", "add", role, "--role", role], place.path, `${password}\n`);
  const served = await serve(["live.toml", "--db", "live.db"], place.path);
  const { page, address } = await visitServed({ ...served, leave: served.kill }, t);
  // signals of the last stroke are there without asking
  await page.goto(address);
  await page.waitForSelector(".tile details[open] canvas");

  const logIn = async (name) => {
    await page.goto(`${address}#view=login`);
    await page.fill(".login input[name=name]", name);
    await page.fill(".login input[name=password]", password);
    await page.click(".login button.primary");
    await page.waitForSelector(".account");
  };
  // a sweep is asked for by who is logged in, and what the controller answers stands there
  await page.goto(`${address}#view=valve`);
  await page.waitForSelector(".valve");
  assert.equal(await page.locator("button[name=sweep]").count(), 0, "nobody asks who is not logged in");
  await logIn("operate");
  page.on("dialog", (dialog) => void dialog.accept());  // the valve moves: one is asked whether one is sure
  await page.goto(`${address}#view=valve`);
  await page.click("button[name=sweep]:not([disabled])");
  await page.waitForSelector(".valve tbody tr");
  assert.match(await page.locator(".valve tbody tr").first().innerText(), /refused\s+the controller refused: the machine is working|measured/);
  assert.match(await page.locator("[data-told]").innerText(), /cushion_1/);
  const checks = JSON.parse(run(["status", "--db", "live.db", "--valve-checks", "--json", "-"], place.path));
  assert.match(JSON.stringify(checks), /refused|measured/, "the command line sees it");

  const before = await untilWatched(address, (machine) => machine.strokes >= enough);
  assert.deepEqual([before.model_version, before.effects], [1, []]);
  press.stdin.write("pause\n");  // while a model is sought
  // at rest, once the stroke has ended, the valve is swept, and its response drawn without another look
  await page.goto(`${address}#view=valve`);
  const rows = page.locator(".valve tbody tr"), newest = rows.first();
  for (let asked = 0; asked < 10 && !/measured/.test(await newest.innerText()); ++asked) {
    const known = await rows.count();
    await page.click("button[name=sweep]:not([disabled])");
    await page.waitForSelector(`.valve tbody tr:nth-child(${known + 1})`);
  }
  assert.match(await newest.innerText(), /measured\s+2\d\d\.\d/);
  await page.waitForSelector(".valve canvas");
  await page.goto(`${address}#view=trends&p=K&x=stroke&from=0&to=${enough}`);
  await page.waitForSelector(`.trends [role=status]:has-text('Strokes 0 to ${enough - 1}')`);
  await page.click("button:has-text('Open these strokes in the workbench')");
  const verdict = await page.waitForSelector("[data-verdict]");
  const said = await page.locator(".headline").first().innerText();
  assert.equal(await verdict.getAttribute("data-verdict"), "named", said);
  assert.match(said, /misses/);
  await page.goto(`${address}#view=workbench&step=compare`);
  await page.waitForSelector(".centre .plot canvas");
  await page.click(".tabs button:has-text('Free run')");
  await page.waitForSelector(".tabs button[aria-pressed=true]:has-text('Free run')");  // and is in the workbench still
  await page.goto(`${address}#view=workbench&step=add&effect=internal_leakage`);
  await page.click("[data-add=internal_leakage]:not([disabled])");
  await page.waitForSelector("[data-error]");
  await page.goto(`${address}#view=workbench&step=promote`);
  await page.waitForSelector(".promote:has-text('This needs the role admin')");
  const { token } = (await (await page.request.get(`${address}api/v1/session`)).json()).user;
  const refused = await page.request.post(`${address}api/v1/promote`, { headers: { "X-Hydroscope-Token": token }, data: { comment: "by an operator" } });
  assert.equal(refused.status(), 403);

  await page.click(".account button:has-text('Log out')");
  await logIn("admin");
  await page.goto(`${address}#view=workbench&step=promote`);
  await page.waitForSelector("[data-promoted='1']");
  await assertAccessible(page, "promote");
  await assertFits(page, "promote");
  assert.ok(await page.locator(".promote button.primary").isDisabled(), "a promotion has a reason");
  await tabTo(page, "textarea[name=promote-comment]");
  await page.keyboard.type("the seal leaks until it is changed");
  await pressKey(page, ".promote button.primary");
  await page.waitForSelector("[data-done]");

  press.stdin.write("run\n");
  // the service goes by it: strokes that come now are identified with the effect
  const stored = await untilWatched(address, (machine) => machine.effects.includes("internal_leakage"));
  const after = await untilWatched(address, (machine) => machine.parameters.some((p) => p.trend && p.parameter === "internal_leakage.G" && p.value > 0));
  assert.ok(after.model_version > before.model_version && after.strokes >= stored.strokes);
  const leak = await untilWatched(address, (machine) => machine.parameters.some((p) => p.parameter === "internal_leakage.G" && p.reason === "updated" && p.value > 1e-12 && p.value < 8e-12));
  assert.ok(leak.strokes > before.strokes);
  await page.goto(`${address}#view=overview`);
  await page.waitForSelector(".tile .facts-line:has-text('+ Internal leakage past the piston seal')");
  // and the trend says when, once drawn
  await page.addInitScript(recordTexts);
  await page.goto(`${address}?#view=trends&p=K`);
  await page.waitForSelector(".marks li:has-text('model version'):has-text('stroke')");
  assert.match(await page.locator(".marks li", { hasText: "model version" }).innerText(), /version \d+ · stroke \d+ · model version \d+ after \d+/);
  await until(page, () => window.drawnTexts.has("M"));
  const { journal } = await (await page.request.get(`${address}api/v1/watch/journal`)).json();
  const row = journal.find((entry) => entry.event === "model_promoted");
  assert.deepEqual([row.user, row.comment], ["admin", "the seal leaks until it is changed"]);
  const { audit } = await (await page.request.get(`${address}api/v1/audit`)).json();
  assert.ok(audit.some((entry) => entry.what === "promote" && entry.user === "admin" && entry.outcome === ""));
});
