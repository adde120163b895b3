// 200 event streams, 50 of which read nothing: how long other requests take, what memory the program needs, and whether a service
// that watches four cylinders meanwhile loses anything. node streams.mjs [SECONDS]. HYDROSCOPE names the program.

import { spawn } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { connect } from "node:net";
import { join } from "node:path";
import { folder, open, program, run, serve } from "./program.mjs";

const seconds = Number(process.argv[2] ?? 20), streams = 200, stalled = 50;
const machines = new URL("../../machines/", import.meta.url).pathname;
const place = folder();

/** Asks one request after the other beside the streams; `work` is told how many there were. */
async function beside({ address, pid }, what, request, work = async () => {}) {
  const { port, host } = new URL(address);
  const memory = () => Number(readFileSync(`/proc/${pid}/status`, "utf8").match(/VmRSS:\s+(\d+)/)[1]) / 1024;
  const counts = new Array(streams).fill(0);
  const sockets = counts.map((_, k) => {
    const socket = connect(Number(port), "127.0.0.1");
    socket.write(`GET /api/v1/events HTTP/1.1\r\nHost: ${host}\r\n\r\n`);
    if (k < stalled) socket.pause();
    else socket.on("data", (piece) => { counts[k] += piece.toString().split("data: ").length - 1; });
    socket.on("error", () => {});
    return socket;
  });
  await new Promise((resolve) => setTimeout(resolve, 500));
  const times = [];
  let begin = 0;
  for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
    await work(times.length);
    const start = performance.now();
    await (await fetch(`${address}api/v1/${request}`)).text();
    times.push(performance.now() - start);
    if (times.length === 100) begin = memory();
  }
  const after = memory();
  times.sort((a, b) => a - b);
  const at = (share) => times[Math.floor(share * (times.length - 1))].toFixed(1);
  const read = counts.slice(stalled);
  console.log(`${what}: ${streams} streams, ${stalled} of them stalled, ${seconds} s, ${times.length} requests beside them`);
  console.log(`requests took ${at(0.5)} ms in the median, ${at(0.99)} ms at p99, ${at(1)} ms at most`);
  console.log(`events per stream that reads: ${Math.min(...read)} ... ${Math.max(...read)}`);
  console.log(`memory ${begin.toFixed(0)} MB after 100 requests, ${after.toFixed(0)} MB at the end`);
  for (const socket of sockets) socket.destroy();
}

run(["simulate", "press", "--out", "press.csv", "--seconds", "60"], place.path);
const worked = await open(["press.csv", "--machine", join(machines, "die_cushion.toml")], place.path);
const { token } = (await (await fetch(`${worked.address}api/v1/session`)).json()).user;
await beside(worked, "a log worked on", "session", async (count) => {
  if (count % 10 === 0) await fetch(`${worked.address}api/v1/work`, { method: "POST", headers: { "X-Hydroscope-Token": token }, body: '{"kind": "picture"}' });
});
await worked.stop();

const live = readFileSync(join(machines, "press_live.toml"), "utf8")
  .replace("domain = 0", `domain = ${20 + (process.pid % 200)}`).replace("port = 1502", `port = ${41_000 + (process.pid % 9_000)}`);
writeFileSync(join(place.path, "live.toml"), live);
const press = spawn(program, ["simulate", "press", "--serve", "live.toml", "--seed", "1"], { cwd: place.path, stdio: ["pipe", "ignore", "ignore"] });
const served = await serve(["live.toml", "--db", "live.db"], place.path);
const status = async () => (await (await fetch(`${served.address}api/v1/watch/service`)).json()).service;
const strokes = (told) => (told?.axes ?? []).reduce((sum, axis) => sum + axis.strokes, 0);
while (strokes(await status()) < 8) await new Promise((resolve) => setTimeout(resolve, 500));
const before = await status();
await beside(served, "a press watched", "watch/overview", () => new Promise((resolve) => setTimeout(resolve, 5)));
const after = await status(), { writer, inbox, axes } = after;
console.log(`${strokes(after) - strokes(before)} strokes stored meanwhile; lost: ${writer.dropped_strokes} strokes, ${writer.dropped_rows} rows, ${inbox.dropped_batches} batches; gaps: ${axes.reduce((sum, axis) => sum + axis.counters.gaps, 0)}`);
await served.stop();
press.kill("SIGTERM");
place.remove();
