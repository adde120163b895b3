// What a German reader may not meet on a page.

import assert from "node:assert/strict";
import { settled } from "./browser_fixture.mjs";

// What stays English: what commands print, how a proposed machine file came about, literature, names of tags, lines of the log.
const english = ".printed, pre, code, .code, .tags, td[title], .facts dd[lang=en], .katex, script, style, noscript, option[value]";
// Words that English sentences have and German ones have not.
const words = "the|and|of|with|without|these|this|that|are|from|between|which|than|strokes|episodes|have|has|would|could|their|them|only|value|change|changed|pressure|measured|model|noise|speed|warning|refused|added";

/** Sentences and names on the page that read English. */
async function englishOn(page) {
  return page.evaluate(([leftOut, pattern]) => {
    const english = new RegExp(`(?<![\\w./-])(${pattern})(?![\\w.=])`, "i"), found = new Set();
    const tell = (text) => { const told = text.replace(/\s+/g, " ").trim(); if (english.test(told)) found.add(told); };
    const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node; (node = walk.nextNode());) if (!node.parentElement.closest(leftOut)) tell(node.textContent);
    for (const marked of document.querySelectorAll("[lang=en]")) if (!marked.closest(leftOut)) found.add(`lang=en: ${marked.textContent.trim()}`);
    for (const named of document.querySelectorAll("[title], [aria-label], [placeholder]"))
      if (!named.closest(leftOut)) for (const name of ["title", "aria-label", "placeholder"]) tell(named.getAttribute(name) ?? "");
    return [...found];
  }, [english, words]);
}

/** Opens what is folded, and holds that nothing of the page reads English. */
export async function assertGerman(page, where) {
  await page.evaluate(() => { for (const fold of document.querySelectorAll("details")) fold.open = true; });
  await settled(page);
  assert.deepEqual(await englishOn(page), [], where);
}
