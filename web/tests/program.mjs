// Starts the program and a browser for the tests. HYDROSCOPE names the program, CHROMIUM the browser.

import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { connect } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

export const program = process.env.HYDROSCOPE ?? "hydroscope";

/** A folder for one test, and how to remove it. */
export function folder() {
  const path = mkdtempSync(join(tmpdir(), "hydroscope_browser_"));
  return { path, remove: () => rmSync(path, { recursive: true, force: true }) };
}

/** Runs a command to its end; its stdout. */
export function run(words, cwd, input = "") {
  const done = spawnSync(program, words, { cwd, input, encoding: "utf8", maxBuffer: 64 << 20 });
  if (done.status !== 0 && done.status !== 4) throw new Error(`${words.join(" ")}: ${done.stderr}`);
  return done.stdout;
}

/** `hydroscope open`: address and how to end it, once its work is done (stop) or without waiting for that (leave). What it unpacks
 * lies in the folder. */
export function open(words, cwd) {
  const child = spawn(program, ["open", ...words], { cwd, stdio: ["ignore", "pipe", "pipe"], env: { ...process.env, TMPDIR: cwd ?? tmpdir() } });
  const ended = new Promise((resolve) => child.on("exit", resolve)), stop = () => { child.kill("SIGTERM"); return ended; };
  child.stderr.pipe(process.stderr);
  const leave = () => { child.stderr.once("data", () => child.kill("SIGTERM")); return stop(); };  // when it says that it works on
  return new Promise((resolve, reject) => {
    let text = "";
    child.stdout.on("data", (piece) => {
      text += piece;
      const address = text.match(/http:\/\/127\.0\.0\.1:\d+\//);
      if (address) resolve({ address: address[0], pid: child.pid, stop, leave });
    });
    child.on("exit", (code) => reject(new Error(`open ended with ${code}: ${text}`)));
  });
}

function answers(port) {
  return new Promise((resolve) => {
    const link = connect(port, "127.0.0.1", () => { link.destroy(); resolve(true); });
    link.on("error", () => resolve(false));
  });
}

let services = 0;
/** `hydroscope serve`, at a port of its own if none is given, below those that outgoing connections take; address and how to end
 * it, as it should (stop) or at once (kill). */
export async function serve(words, cwd, port = 20_000 + ((process.pid * 8 + services++) % 12_000)) {
  const child = spawn(program, ["serve", ...words, "--port", String(port)], { cwd, stdio: ["ignore", "ignore", "ignore"] });
  const ended = new Promise((resolve) => child.on("exit", resolve));
  const address = `http${words.includes("--certificate") ? "s" : ""}://127.0.0.1:${port}/`, stop = () => { child.kill("SIGTERM"); return ended; }, kill = () => { child.kill("SIGKILL"); return ended; };
  for (let k = 0; k < 1200; ++k) {
    if (child.exitCode !== null) throw new Error(`serve ended with ${child.exitCode}`);
    if (await answers(port)) return { address, port, pid: child.pid, stop, kill };
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  await stop();
  throw new Error("serve does not answer");
}

export function browser() {
  return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"] });
}
