// What the program answers is what docs/openapi.json says: every request of it is made of a program that has something to tell.
// node --test api_test.mjs. HYDROSCOPE names the program.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { addValveChecks, makeHistory } from "./history.mjs";
import { folder, open, run, serve } from "./program.mjs";

const { paths, components } = JSON.parse(readFileSync(fileURLToPath(new URL("../../docs/openapi.json", import.meta.url)), "utf8"));
const machines = fileURLToPath(new URL("../../machines", import.meta.url));
const place = folder(), asked = new Set();

before(() => {
  run(["simulate", "press", "--out", "leak.csv", "--seconds", "40", "--seed", "4", "--effect", "internal_leakage=4e-12"], place.path);
  makeHistory(place.path);
  addValveChecks(place.path);
});
after(() => place.remove());

const typeOf = (value) => (value === null ? "null" : Array.isArray(value) ? "array" : Number.isInteger(value) ? "integer" : typeof value);

/** Where an answer is not what is described. */
function faults(schema, value, where) {
  if (schema.$ref) return faults(components.schemas[schema.$ref.split("/").pop()], value, where);
  const types = [schema.type ?? []].flat(), type = typeOf(value);
  if (types.length > 0 && !types.includes(type) && !(type === "integer" && types.includes("number"))) return [`${where} is ${type}, not ${types.join(" or ")}`];
  if (type === "array") return value.slice(0, 3).flatMap((item, k) => faults(schema.items ?? {}, item, `${where}[${k}]`));
  if (type !== "object" || !schema.properties) return [];
  return [
    ...Object.keys(value).filter((key) => key !== "schema" && !(key in schema.properties)).map((key) => `${where}.${key} is not described`),
    ...Object.entries(schema.properties).flatMap(([key, of]) => (key in value ? faults(of, value[key], `${where}.${key}`) : [`${where}.${key} is not told`])),
  ];
}

/** Asks, and holds that status and answer are described. */
async function ask(address, method, path, { query = "", body, headers = {} } = {}) {
  const described = paths[`/${path}`][method.toLowerCase()];
  asked.add(`${method} ${path}`);
  const response = await fetch(`${address}api/v1/${path}${query}`, { method, headers, body: typeof body === "object" ? JSON.stringify(body) : body });
  const { content } = described.responses[response.status] ?? described.responses.default, where = `${method} ${path}${query}: ${response.status}`;
  if (content === undefined && described.responses[response.status] === undefined) assert.ok(response.status >= 400, where);
  if (path === "machine" && method === "GET") return response.text();
  const json = await response.json();
  assert.ok(json.schema >= 1, `${where}: the version of its schema`);
  assert.deepEqual(faults(content?.["application/json"]?.schema ?? components.schemas.Error, json, where), []);
  return { status: response.status, ...json };
}

/** A program with its token; what it does is waited for. */
async function started(t, words) {
  const served = await open(words, place.path);
  t.after(() => served.leave());
  const { user } = await (await fetch(`${served.address}api/v1/session`)).json();
  const headers = { "X-Hydroscope-Token": user.token };
  const get = (path, query) => ask(served.address, "GET", path, { query });
  const post = async (path, body = {}, query = "") => {
    const answer = await ask(served.address, "POST", path, { query, body, headers });
    for (let ended = answer.job === undefined; !ended; await new Promise((resolve) => setTimeout(resolve, 100)))
      ended = ["done", "failed"].includes((await get("session")).jobs.find(({ job }) => job === answer.job)?.state);
    return answer;
  };
  return { get, post };
}

/** Until the database was read for the first time. */
async function untilRead(overview) {
  for (let k = 0; k < 600 && (await overview()).status === 404; ++k) await new Promise((resolve) => setTimeout(resolve, 100));
}

test("work on logs", async (t) => {
  const { get, post } = await started(t, []);
  await get("session");
  assert.equal((await post("logs", readFileSync(join(place.path, "leak.csv"), "utf8"), "?name=leak.csv")).status, 200);
  assert.equal((await post("proposal", { geometry: { A_A: 0.0125 } })).status, 200);
  await post("accept");
  await post("reopen");
  await post("proposal", { geometry: { A_A: 0.0125 } });
  await post("accept");
  for (const kind of ["check", "compare", "explain", "picture"]) {
    await post("work", { kind });
    assert.equal((await get("results", `?kind=${kind}`)).status, 200, kind);
  }
  assert.equal((await get("results", "?kind=nothing")).status, 404);
  await get("session");
  await get("effects");
  assert.equal((await get("strokes", "?stroke=0")).status, 200);
  assert.ok((await get("region", "?where=")).strokes.length > 0);
  assert.equal((await get("region", "?where=nothing:1:2")).status, 400);
  assert.match(await get("machine"), /model = "die_cushion"/);
  assert.ok((await post("effect", { id: "own", expression: "p_A" })).course.values.length > 0);
  await post("measured", { effect: "tank_pressure", size: 0, std: 1e4 });
  await post("hold_out", { log: "" });
  assert.match((await post("save", { name: "api.toml" })).path, /api\.toml$/);
  for (const [path, body] of [["strokes", { machine: "die_cushion", first: 0, last: 1 }], ["promote", { comment: "better" }], ["login", { name: "a", password: "b" }], ["logout", {}]])
    assert.ok((await post(path, body)).status >= 400, `${path} is refused without a database and users`);
  await post("machine", readFileSync(join(machines, "die_cushion.toml"), "utf8"), "?name=press.toml");
  await post("start_over");
  const { examples } = await get("session");
  await post("example", { id: examples[0] });
  assert.equal((await get("audit")).status, 404);
});

test("what is watched", async (t) => {
  const { get, post } = await started(t, ["--db", "press.db", "--machine", "press.toml"]);
  await untilRead(() => get("watch/overview"));
  const { machines: watched } = await get("watch/overview");
  assert.equal(watched[0].machine, "die_cushion");
  await get("session");
  for (const [path, query] of [["watch/trend", "?machine=die_cushion&parameter=K"], ["watch/stroke", "?machine=die_cushion"], ["watch/alarms", ""],
    ["watch/journal", "?machine=die_cushion&alarm=internal_leakage"], ["watch/valve_checks", "?machine=die_cushion"], ["watch/learning", "?machine=die_cushion"], ["watch/tags", ""], ["watch/service", ""]])
    assert.ok([200, path === "watch/stroke" ? 404 : 200].includes((await get(path, query)).status), path);
  await post("watch/learning", { machine: "die_cushion", first: 0, last: 99, only_look: true });
  await get("watch/learning", "?machine=die_cushion");
  assert.equal((await post("watch/valve_checks", { machine: "die_cushion" })).status, 400, "no service runs");
  assert.equal((await post("watch/alarms", { action: "acknowledge", machine: "die_cushion", alarm: "internal_leakage", user: "anna" })).changed, true);
  await post("strokes", { machine: "die_cushion", first: 0, last: 20 });
  await get("session");
});

test("a service, with who may what", async (t) => {
  run(["users", "--db", "api.db", "add", "anna", "--role", "admin"], place.path, "long enough to guess\n");
  const served = await serve([join(machines, "press_live.toml"), "--db", "api.db"], place.path);
  t.after(() => served.stop());
  const send = (method, path, more) => ask(served.address, method, path, more);
  assert.equal((await send("POST", "login", { body: { name: "anna", password: "wrong" } })).status, 401);
  const login = await fetch(`${served.address}api/v1/login`, { method: "POST", body: JSON.stringify({ name: "anna", password: "long enough to guess" }) });
  const headers = { Cookie: login.headers.get("set-cookie").split(";")[0], "X-Hydroscope-Token": (await login.json()).user.token };
  assert.equal((await send("POST", "login", { body: { name: "anna", password: "long enough to guess" } })).status, 200);
  await untilRead(() => send("GET", "watch/overview", { headers }));
  for (const path of ["session", "audit", "watch/overview", "watch/service", "watch/tags"]) assert.equal((await send("GET", path, { headers })).status, 200, path);
  assert.equal((await send("POST", "logout", { headers })).status, 200);
  const status = await (await fetch(`${served.address}status`)).json();
  assert.deepEqual(faults(paths["/status"].get.responses[200].content["application/json"].schema, status, "status"), []);
});

test("every request that is described was made", () => {
  const described = Object.entries(paths).filter(([, item]) => !item.servers).flatMap(([path, item]) => Object.keys(item).map((method) => `${method.toUpperCase()} ${path.slice(1)}`));
  assert.deepEqual(described.filter((one) => !asked.has(one)), ["GET events"]);  // which has no end: page_test.mjs
});
