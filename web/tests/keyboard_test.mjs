// The whole way from a log to a saved model without a mouse, and what stands on it in the language of the reader.
// node --test keyboard_test.mjs. HYDROSCOPE names the program, CHROMIUM the browser.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { endBrowser, press, startBrowser, tabTo, until, visitIn } from "./browser_fixture.mjs";
import { folder, run } from "./program.mjs";

const place = folder();

before(async () => {
  await startBrowser();
  run(["simulate", "press", "--out", "hidden.csv", "--seconds", "90", "--seed", "4", "--effect", "relief_valve=3e-11"], place.path);
});
after(async () => {
  await endBrowser();
  place.remove();
});

const strokesOf = async (page) => Number((await page.locator(".log-view [role=status]").innerText()).match(/: (\d+) stroke/)[1]);

test("a log is chosen, mapped, its gate changed, the effect added and the model saved by keys alone", async (t) => {
  const { page, address } = await visitIn(place.path, t, []);
  await page.goto(address);
  await page.waitForSelector(".drop");
  const chooser = page.waitForEvent("filechooser");
  await press(page, ".drop button.primary");
  await (await chooser).setFiles(join(place.path, "hidden.csv"));
  await page.waitForSelector(".pin.sure");
  await tabTo(page, "input[name=A_A-bore]");
  await page.keyboard.type("126.157");
  await page.waitForSelector(".gate-plot canvas");
  const all = await strokesOf(page);

  // one more condition of the gate: it counts once a threshold is written, and is taken out again
  await tabTo(page, "select[name=gate-signal]");
  await page.keyboard.type("p_A");
  await tabTo(page, "[aria-label='p_A from']");
  await page.keyboard.type("150");
  await page.keyboard.press("Tab");
  await page.waitForSelector(".gate-plot[data-bound=p_A] canvas");
  assert.ok(await page.locator(".condition.new select").count() === 1, "the next one can be added");
  await until(page, `/\\d+ stroke/.test(document.querySelector(".log-view [role=status]").textContent)`);
  assert.notEqual(await strokesOf(page), all, "strokes are counted anew");
  assert.match(await (await fetch(`${address}api/v1/session`)).text(), /"logs"/);
  await press(page, "[aria-label='Take out: p_A']");
  await page.waitForSelector(".gate-plot[data-bound=p_A]", { state: "detached" });
  await page.waitForSelector(".verdict.good");
  await press(page, ".mapping > button.primary");

  await page.waitForSelector(".heat, .scrubber, .machine");
  await press(page, ".stepper li:nth-child(3) button");
  await page.waitForSelector(".cell.heat-5");
  await press(page, ".cell.heat-5");
  await press(page, "[data-region] button.primary");
  await page.waitForSelector(".scrubber");
  await page.waitForSelector("[data-effect=relief_valve]");
  await press(page, "[data-effect=relief_valve]");
  await page.waitForSelector("[data-add=relief_valve]:not([disabled])");
  await press(page, "[data-add=relief_valve]");
  await page.waitForSelector("[data-error]");
  await tabTo(page, "input[name=file]");
  await page.keyboard.press("Control+a");
  await page.keyboard.type("by_keys.toml");
  await press(page, ".save button.primary");
  await page.waitForSelector("[data-saved]");
});
