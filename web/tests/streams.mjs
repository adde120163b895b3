// 200 event streams, 50 of which read nothing, while work goes on: how long other requests take, and what memory the
// program needs. node streams.mjs [SECONDS]. HYDROSCOPE names the program.

import { readFileSync } from "node:fs";
import { connect } from "node:net";
import { folder, open, run } from "./program.mjs";

const seconds = Number(process.argv[2] ?? 20), streams = 200, stalled = 50;
const place = folder();
run(["simulate", "press", "--out", "press.csv", "--seconds", "60"], place.path);
const machine = new URL("../../machines/die_cushion.toml", import.meta.url).pathname;
const served = await open(["press.csv", "--machine", machine], place.path);
const { port, host } = new URL(served.address);
const { token } = (await (await fetch(`${served.address}api/v1/session`)).json()).user;
const memory = () => Number(readFileSync(`/proc/${served.pid}/status`, "utf8").match(/VmRSS:\s+(\d+)/)[1]) / 1024;

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
let begin = 0, works = 0;
const end = Date.now() + 1000 * seconds;
while (Date.now() < end) {
  if (++works % 10 === 0)
    await fetch(`${served.address}api/v1/work`, { method: "POST", headers: { "X-Hydroscope-Token": token }, body: '{"kind": "picture"}' });
  const start = performance.now();
  await (await fetch(`${served.address}api/v1/session`)).text();
  times.push(performance.now() - start);
  if (times.length === 100) begin = memory();
}
const after = memory();
times.sort((a, b) => a - b);
const at = (share) => times[Math.floor(share * (times.length - 1))].toFixed(1);
const read = counts.slice(stalled);
console.log(`${streams} streams, ${stalled} of them stalled, ${seconds} s, ${times.length} requests beside them`);
console.log(`requests took ${at(0.5)} ms in the median, ${at(0.99)} ms at p99, ${at(1)} ms at most`);
console.log(`events per stream that reads: ${Math.min(...read)} ... ${Math.max(...read)}`);
console.log(`memory ${begin.toFixed(0)} MB after 100 requests, ${after.toFixed(0)} MB at the end`);
for (const socket of sockets) socket.destroy();
await served.stop();
place.remove();
