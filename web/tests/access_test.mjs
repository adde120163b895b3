// Logins, roles and what they guard, in a real browser: node --test access_test.mjs. HYDROSCOPE names the program, CHROMIUM
// the browser.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { cpSync } from "node:fs";
import { request as plainRequest } from "node:http";
import { request as tlsRequest } from "node:https";
import { connect } from "node:net";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { assertLooksGood, endBrowser, patience, startBrowser, visitServed } from "./browser_fixture.mjs";
import { copyHistory, makeHistory } from "./history.mjs";
import { folder, program, run, serve } from "./program.mjs";

const place = folder();
const machine = fileURLToPath(new URL("../../machines/press_live.toml", import.meta.url));
const password = "long enough to guess";
const json = (words) => JSON.parse(run([...words, "--json", "-"], place.path));
const leak = { machine: "die_cushion", alarm: "internal_leakage" };

before(async () => {
  makeHistory(place.path);
  for (const role of ["view", "operate", "admin"]) run(["users", "--db", "press.db", "add", role, "--role", role], place.path, `${password}\n`);
  const made = spawnSync("openssl", ["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-noenc", "-days", "1", "-subj", "/CN=press7",
    "-keyout", "page.key", "-out", "page.pem"], { cwd: place.path, encoding: "utf8" });
  assert.equal(made.status, 0, made.stderr);
  await startBrowser();
});
after(async () => {
  await endBrowser();
  place.remove();
});

/** A database of its own with a user of each role, named as the role. */
function databaseWithUsers(name) {
  copyHistory(place.path, name);
  cpSync(join(place.path, "press.access.db"), join(place.path, `${name}.access.db`));
  return [machine, "--db", `${name}.db`];
}

/** A request as other programs could send it, on a connection of its own: one that is kept may have been closed for idleness by the
 * time a command of the test has run. */
function ask(address, method, path, { headers = {}, body } = {}) {
  const text = body === undefined ? "" : JSON.stringify(body);
  return new Promise((resolve, reject) => {
    const sent = (address.startsWith("https") ? tlsRequest : plainRequest)(new URL(path, address), { method, headers, agent: false, rejectUnauthorized: false }, (answer) => {
      let got = "";
      answer.on("data", (piece) => { got += piece; });
      answer.on("end", () => resolve({ status: answer.statusCode, headers: answer.headers, json: got.startsWith("{") ? JSON.parse(got) : got }));
    });
    sent.on("error", reject);
    sent.end(text);
  });
}

/** Logs in without a browser: the headers of what changes something. */
async function headersOf(address, name) {
  const answer = await ask(address, "POST", "api/v1/login", { body: { name, password } });
  assert.equal(answer.status, 200, JSON.stringify(answer.json));
  return { Cookie: answer.headers["set-cookie"][0].split(";")[0], "X-Hydroscope-Token": answer.json.user.token };
}

async function logIn(page, name, secret = password) {
  await page.fill(".login input[name=name]", name);
  await page.fill(".login input[name=password]", secret);
  await page.click(".login button.primary");
}

test("an operator acknowledges at the port of the service, a viewer does not, and a restart ends no login", async (t) => {
  const words = databaseWithUsers("shift");
  const served = await serve(words, place.path);
  const { page, address } = await visitServed(served, t);
  const alarm = `${address}#view=alarms&alarm=die_cushion/internal_leakage`;
  await page.goto(alarm);
  await page.click(".detail button:has-text('Log in to acknowledge')");
  await logIn(page, "view", "a wrong password");
  await page.waitForSelector(".login .problem:has-text('Name or password is wrong')");
  await logIn(page, "view");
  await page.waitForSelector(".account:has-text('view')");
  await page.goto(alarm);
  await page.waitForSelector(".detail:has-text('You may look')");
  assert.equal(await page.locator(".act").count(), 0);
  await page.click(".account button:has-text('Log out')");
  await page.click(".detail button:has-text('Log in to acknowledge')");
  await logIn(page, "operate");
  await page.waitForSelector(".account:has-text('operate')");
  await page.goto(alarm);
  await page.fill(".act textarea", "seal ordered");
  await page.click("button:has-text('Acknowledge')");
  await page.waitForSelector(".detail[data-state=ACKED]");
  const acknowledged = json(["alarms", "--db", "shift.db", "journal"]).journal.filter((row) => row.event === "acknowledged");
  assert.deepEqual(acknowledged.map((row) => [row.user, row.comment]), [["operate", "seal ordered"]]);
  assert.equal(await page.locator(".views button:has-text('Changes')").count(), 0, "what others did is for admins");

  await page.fill(".act textarea", "typed before the restart");
  await served.stop();
  await page.waitForSelector(".lost");
  const again = await serve(words, place.path, served.port);
  t.after(() => again.stop());
  await page.waitForSelector(".lost", { state: "detached" });
  assert.equal(await page.inputValue(".act textarea"), "typed before the restart");
  await page.click("button:has-text('Only the remark')");
  await page.waitForSelector(".journal li:has-text('typed before the restart')");

  await page.click(".account button:has-text('Log out')");
  await page.click(".top button:has-text('Log in')");
  await logIn(page, "admin");
  await page.click(".views button:has-text('Changes')");
  await page.waitForSelector(".audit tbody tr");
  const rows = await page.locator(".audit tbody tr").allInnerTexts();
  assert.ok(rows.some((row) => /operate.*127\.0\.0\.1\s+alarm\s+acknowledged · die_cushion\/internal_leakage · remark: seal ordered/.test(row)), rows.join("\n"));
  assert.ok(rows.some((row) => /view.*log-in.*refused/.test(row.replace(/\s+/g, " "))), "a wrong password stands there");
  assert.ok(rows.some((row) => /user added/.test(row)));
});

test("each request is looked at: role, token, Origin, Host, and who is logged in is who acts", async (t) => {
  const served = await serve(databaseWithUsers("requests"), place.path);
  t.after(() => served.stop());
  const { address } = served;
  const act = (headers) => ask(address, "POST", "api/v1/watch/alarms", { headers, body: { action: "comment", ...leak, comment: "looked", user: "somebody else" } }).then((answer) => answer.status);
  const view = await headersOf(address, "view"), operate = await headersOf(address, "operate"), admin = await headersOf(address, "admin");
  assert.equal(await act({}), 401);
  assert.equal(await act(view), 403);
  assert.equal(await act({ Cookie: operate.Cookie }), 403, "without the token");
  assert.equal(await act({ ...operate, "X-Hydroscope-Token": admin["X-Hydroscope-Token"] }), 403, "with the token of another login");
  assert.equal(await act({ ...operate, Origin: "http://evil.example" }), 403);
  assert.equal(await act({ ...operate, "Sec-Fetch-Site": "cross-site" }), 403);
  assert.equal(await act({ ...operate, Host: "evil.example" }), 421);
  assert.equal(await act({ "X-Hydroscope-Token": operate["X-Hydroscope-Token"] }), 401, "with the token alone");
  assert.equal(await act(operate), 200);
  const journal = json(["alarms", "--db", "requests.db", "journal"]).journal.filter((row) => row.event === "commented");
  assert.deepEqual(journal.map((row) => row.user), ["operate"]);
  const status = (path, headers) => ask(address, "GET", path, { headers }).then((answer) => answer.status);
  assert.equal(await status("api/v1/audit", operate), 403);
  assert.equal(await status("api/v1/audit", admin), 200);
  assert.equal(await status("api/v1/watch/service", {}), 200, "on this computer everybody may look");
  assert.equal(await status("metrics", {}), 200);
  assert.equal(await ask(address, "POST", "api/v1/logs", { headers: { ...operate, "Content-Length": String(3 * 2 ** 30) } }).then((answer) => answer.status), 413);

  run(["users", "--db", "requests.db", "remove", "operate"], place.path);
  assert.equal(await act(operate), 401, "a user who is removed is logged out");
  assert.equal(await ask(address, "POST", "api/v1/logout", { headers: view, body: {} }).then((answer) => answer.status), 200);
  assert.equal(await act(view), 401);
});

test("passwords cannot be guessed fast", async (t) => {
  const served = await serve(databaseWithUsers("guessed"), place.path);
  t.after(() => served.stop());
  const attempt = (secret) => ask(served.address, "POST", "api/v1/login", { body: { name: "admin", password: secret } });
  for (let k = 0; k < 5; ++k) assert.equal((await attempt(`guess number ${k}`)).status, 401);
  const late = await attempt(password);
  assert.equal(late.status, 429, "not even the right one");
  assert.ok(Number(late.headers["retry-after"]) > 800);
});

test("other computers see nothing without a login, and speak TLS", async (t) => {
  const words = [...databaseWithUsers("elsewhere"), "--listen", "0.0.0.0"];
  const bare = spawnSync(program, ["serve", ...words, "--port", "0"], { cwd: place.path, encoding: "utf8", timeout: patience });
  assert.equal(bare.status, 2, bare.stderr);
  assert.match(bare.stderr, /--certificate and --key/);

  const served = await serve([...words, "--certificate", "page.pem", "--key", "page.key", "--host-name", "press7.plant"], place.path);
  const { page, address } = await visitServed(served, t, { ignoreHTTPSErrors: true });
  const status = (path, headers = {}) => ask(address, "GET", path, { headers }).then((answer) => answer.status);
  for (const path of ["api/v1/watch/overview", "api/v1/watch/alarms", "api/v1/events", "api/v1/effects", "metrics", "status"])
    assert.equal(await status(path), 401, path);
  assert.deepEqual((await ask(address, "GET", "api/v1/session")).json, { schema: 1, user: null, login: { to_read: true, users: true } });
  assert.equal(await status("", { Host: `press7.plant:${served.port}` }), 200);
  assert.equal(await status("", { Host: `evil.example:${served.port}` }), 421);
  assert.equal(await fetch(address.replace("https", "http")).then((answer) => answer.status, () => 0), 0, "no plain HTTP");
  const silent = Array.from({ length: 400 }, (_, k) => connect(served.port, "127.0.0.1").on("error", () => {}).on("connect", function () { if (k % 2) this.write("\x16\x03\x01\x02"); }));
  await Promise.all(silent.map((socket) => new Promise((done) => socket.once("connect", done).once("close", done))));
  const begin = performance.now();
  assert.equal(await status("api/v1/effects"), 401);
  assert.ok(performance.now() - begin < 10_000, "who never ends a handshake keeps nobody out");
  for (const socket of silent) socket.destroy();

  await page.goto(`${address}#view=alarms&alarm=die_cushion/internal_leakage`);
  await page.waitForSelector(".login");
  assert.equal(await page.locator(".views").count(), 0);
  await logIn(page, "operate");
  await page.fill(".act textarea", "typed before the login ended");
  const cookie = (await page.context().cookies()).find((c) => c.name.includes("hydroscope"));
  assert.deepEqual([cookie.secure, cookie.httpOnly, cookie.sameSite, cookie.name.startsWith("__Host-")], [true, true, "Strict", true]);
  run(["users", "--db", "elsewhere.db", "change", "operate"], place.path, "another long password\n");
  await page.click("button:has-text('Acknowledge')");
  await page.waitForSelector(".login");
  assert.ok(!(await page.locator(".alarms").isVisible()), "what was looked at is covered");
  await logIn(page, "operate", "another long password");
  await page.waitForSelector(".login", { state: "detached" });
  assert.equal(await page.inputValue(".act textarea"), "typed before the login ended");
  await page.click("button:has-text('Acknowledge')");
  await page.waitForSelector(".detail[data-state=ACKED]");
});

test("a user is not removed where that cannot be recorded", () => {
  databaseWithUsers("full");
  const audit = (statement) => assert.equal(spawnSync("sqlite3", ["full.access.db", statement], { cwd: place.path, encoding: "utf8" }).status, 0);
  audit("CREATE TRIGGER full BEFORE INSERT ON audit BEGIN SELECT RAISE(ABORT, 'the disk is full'); END");
  const remove = () => spawnSync(program, ["users", "--db", "full.db", "remove", "view"], { cwd: place.path, encoding: "utf8" });
  const names = () => json(["users", "--db", "full.db", "list"]).users.map((user) => user.name);
  assert.notEqual(remove().status, 0);
  assert.deepEqual(names(), ["admin", "operate", "view"]);
  audit("DROP TRIGGER full");
  assert.equal(remove().status, 0);
  assert.deepEqual(names(), ["admin", "operate"]);
  assert.equal(json(["users", "--db", "full.db", "audit"]).audit.pop().what, "user removed");
});

test("where there are no users the page says how the first one is made", async (t) => {
  copyHistory(place.path, "nobody");
  const { page, address } = await visitServed(await serve([machine, "--db", "nobody.db"], place.path), t);
  await page.goto(`${address}#view=login`);
  await page.waitForSelector(".login:has-text('hydroscope users --db … add NAME --role admin')");
});

test("login and changes are accessible and fit, wide and on a phone, in both languages, light and dark", async (t) => {
  const { page, address } = await visitServed(await serve(databaseWithUsers("look"), place.path), t);
  await page.goto(`${address}#view=login`);
  await page.waitForSelector(".login");
  await assertLooksGood(page, "login");
  await logIn(page, "admin", "a wrong password");
  await page.waitForSelector(".login .problem");
  await assertLooksGood(page, "login refused");
  await logIn(page, "admin");
  await page.waitForSelector(".account");
  for (const [view, there] of [["audit", ".audit tbody tr"], ["alarms&alarm=die_cushion/internal_leakage", ".act"]]) {
    await page.goto(`${address}#view=${view}`);
    await page.waitForSelector(there);
    await assertLooksGood(page, view);
  }
});
