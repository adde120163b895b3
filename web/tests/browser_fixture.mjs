// What the tests in a browser share: one browser, pages of programs, and what every page has to fulfil.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { browser, open } from "./program.mjs";

const axeSource = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
export const patience = 120_000;  // ms, also on a computer with many times more work than cores
let chromium;

export async function startBrowser() { chromium = await browser(); }
export async function endBrowser() { await chromium?.close(); }

/** `hydroscope open` for several tests that change nothing of it, started by the first of them; without options of its own a test takes
 * over the page of the one before, as it is at the beginning. */
export function sharedProgram(words, path) {
  let started, kept;
  const served = async () => ({ ...await (started ??= open(words, path)), leave: async () => {} });
  return {
    visit: async (t, options) => {
      if (options) return visitServed(await served(), t, options);
      kept ??= await pageOf(await served());
      const { page, faults } = kept;
      t.after(async () => {
        page.removeAllListeners("request");
        if (page.url() !== "about:blank") await page.evaluate(() => { localStorage.clear(); sessionStorage.clear(); });
        await page.goto("about:blank");
        assert.deepEqual(faults.splice(0), []);
      });
      return kept;
    },
    end: async () => { if (started) await (await started).leave(); },
  };
}

/** A page, and what fails on it. */
async function pageOf(served, options) {
  const context = await chromium.newContext({ viewport: { width: 1400, height: 900 }, locale: "en-US", ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(patience);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (line) => {
    if (line.type() === "error" && /Content Security Policy|Uncaught/.test(line.text())) faults.push(line.text());
  });
  return { page, address: served.address, served, faults };
}

/** A page of a program of its own, until the test is over; what fails on the page fails the test. */
export async function visitIn(path, t, words, options = {}) {
  return visitServed(await open(words, path), t, options);
}

/** The same of a program that runs. */
export async function visitServed(served, t, options = {}) {
  const visited = await pageOf(served, options);
  t.after(async () => {
    await visited.page.context().close();
    await (served.leave ?? served.stop)();
    assert.deepEqual(visited.faults, []);
  });
  return visited;
}

/** Drops files as a person would, from the desktop. */
export async function drop(page, files) {
  const contents = files.map((file) => ({ name: file.split("/").pop(), text: readFileSync(file, "utf8") }));
  const transfer = await page.evaluateHandle((list) => {
    const data = new DataTransfer();
    for (const { name, text } of list) data.items.add(new File([text], name));
    return data;
  }, contents);
  await page.dispatchEvent(".drop", "drop", { dataTransfer: transfer });
}

/** Waits until the condition holds on the page. (waitForFunction needs eval there, which the page forbids.) */
export async function until(page, condition) {
  for (const end = Date.now() + patience; Date.now() < end;) {
    if (await page.evaluate(condition)) return;
    await page.waitForTimeout(50);
  }
  assert.fail(`not so after ${patience} ms: ${condition}`);
}

/** Waits until what was opened or asked for stands there: the page says the same at two looks. */
export async function settled(page) {
  for (let before = "", now = await page.innerText("body"); before !== now; now = await page.innerText("body")) {
    before = now;
    await page.waitForTimeout(60);
  }
}

/** The errors of the versions of the model, as they stand on the page, once all of them are judged. */
export async function errorsOfVersions(page) {
  await until(page, () => {
    const errors = [...document.querySelectorAll(".staircase .error")];
    return errors.length > 0 && errors.every((error) => /\d/.test(error.textContent));
  });
  return page.locator(".staircase .error").allInnerTexts();
}

/** Takes hold of a threshold in a picture of the gate, and drags it up by half of that; with a finger or the mouse. */
export async function dragThreshold(page, plot, finger = false) {
  await plot.scrollIntoViewIfNeeded();
  const box = await plot.locator(".u-over").boundingBox();
  let line = -1;  // where the pointer says that it can take hold of something
  for (let y = box.y + box.height - 2; y > box.y && line < 0; y -= 4) {
    await page.mouse.move(box.x + box.width / 2, y);
    if (await plot.evaluate((place) => place.style.cursor === "ns-resize")) line = y - 6;
  }
  assert.ok(line > 0, "there is a line to drag");
  const x = box.x + box.width / 2, to = line - box.height / 2;
  if (finger) {
    const devTools = await page.context().newCDPSession(page);
    const touch = (type, y) => devTools.send("Input.dispatchTouchEvent", { type, touchPoints: y === undefined ? [] : [{ x, y }] });
    await touch("touchStart", line);
    for (let k = 1; k <= 5; ++k) await touch("touchMove", line + (k / 5) * (to - line));
    return touch("touchEnd");
  }
  await page.mouse.move(x, line);
  await page.mouse.down();
  await page.mouse.move(x, to, { steps: 5 });
  await page.mouse.up();
}

/** In a page, before it loads: keeps what is written into pictures, in `drawnTexts`. */
export function recordTexts() {
  const write = CanvasRenderingContext2D.prototype.fillText;
  window.drawnTexts = new Set();
  CanvasRenderingContext2D.prototype.fillText = function (text, ...place) {
    window.drawnTexts.add(text);
    return write.call(this, text, ...place);
  };
}

/** Sheets of paper that the page is printed on. */
export const pagesOf = async (page) => (await page.pdf({ format: "A4" })).toString("latin1").match(/\/Type\s*\/Page\b/g).length;

/** Goes to an element with the Tab key alone, as somebody without a mouse does. */
export async function tabTo(page, selector) {
  await page.waitForSelector(selector);
  for (let k = 0; k < 250; ++k) {
    if (await page.evaluate((wanted) => document.activeElement?.matches(wanted) ?? false, selector)) return;
    await page.keyboard.press("Tab");
  }
  assert.fail(`no key leads to ${selector}`);
}

/** Presses a button without a mouse. */
export async function press(page, selector) {
  await tabTo(page, selector);
  await page.keyboard.press("Enter");
}

export async function assertAccessible(page, where) {
  assert.deepEqual((await page.innerText("body")).match(/<[^<>]+[/|][^<>]+>/g), null, `${where}: words left to choose`);
  if (!(await page.evaluate(() => "axe" in globalThis))) await page.evaluate(axeSource);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"], resultTypes: ["violations"] }));
  assert.deepEqual(violations.map((v) => `${where}: ${v.id}: ${v.nodes.map((n) => n.target.join(" ")).slice(0, 3).join(", ")}`), []);
}

/** In a page: what a keyboard has to reach, and of that what Tab comes to and whether the focus shows there. */
const reach = {
  begin: () => {
    const seen = (part) => part.checkVisibility({ visibilityProperty: true }) && part.getClientRects().length > 0;
    const wanted = [...document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex]")]
      .filter((part) => part.tabIndex >= 0 && !part.disabled && seen(part));
    window.reached = { wanted, focused: new Set(), unseen: [] };
    window.reached.listen = ({ target }) => {
      window.reached.focused.add(target);
      const { outlineStyle, outlineWidth } = getComputedStyle(target);
      if (outlineStyle === "none" || parseFloat(outlineWidth) < 2) window.reached.unseen.push(target.outerHTML.slice(0, 90));
    };
    document.addEventListener("focusin", window.reached.listen);
    document.activeElement?.blur();
    getSelection().removeAllRanges();
    return wanted.length;
  },
  end: () => {
    const { wanted, focused, unseen, listen } = window.reached;
    document.removeEventListener("focusin", listen);
    document.activeElement?.blur();
    return { missed: wanted.filter((part) => part.isConnected && !focused.has(part)).map((part) => part.outerHTML.slice(0, 90)), unseen };
  },
};

/** Tab comes to everything that can be used, with a focus that shows, and is kept nowhere. */
export async function assertReachable(page, where) {
  const count = await page.evaluate(reach.begin);
  for (let k = 0; k < count + 2; ++k) await page.keyboard.press("Tab");
  assert.deepEqual(await page.evaluate(reach.end), { missed: [], unseen: [] }, where);
}

let looks = 0;
/** Pages look the same to all: wide, light and in the language that they begin with, and on a phone, dark and in the other one, without
 * loading anew; keys reach all of it. axe sees each page once, this way and that in turn. */
export async function assertLooksGood(page, where) {
  const language = await page.getAttribute("html", "lang"), other = language === "de" ? "en" : "de", axed = looks++ % 2 ? "dark" : "light";
  for (const [size, scheme, chosen] of [[{ width: 390, height: 844 }, "dark", other], [{ width: 1400, height: 900 }, "light", language]]) {
    await page.setViewportSize(size);
    await page.emulateMedia({ colorScheme: scheme });
    await until(page, `document.documentElement.dataset.theme === "${scheme}"`);
    await page.selectOption(".top select >> nth=-1", chosen);
    const seen = `${where}, ${size.width} wide, ${scheme}, ${chosen}`;
    await assertFits(page, seen);
    if (scheme === axed) await assertAccessible(page, seen);
  }
  await assertReachable(page, where);
}

export async function assertFits(page, where) {
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(wide <= 0, `${where} is ${wide} pixels wider than the window`);
  const small = await page.evaluate(() => (innerWidth > 720 ? [] : [...document.querySelectorAll("button:not(.cell), select, summary, input:not([type=range], [type=checkbox], [type=radio])")]
    .filter((field) => field.offsetParent !== null && field.getBoundingClientRect().height < 32).map((field) => field.textContent || field.name)));
  assert.deepEqual(small, [], `${where}: too small for a finger`);
}
