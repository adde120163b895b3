// A database for the tests and pictures of watching: a press learned healthy, then with a leak, one shift after the other.
// node history.mjs FOLDER makes it there; tests take it from there where HYDROSCOPE_HISTORY names the folder.

import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { spawnSync } from "node:child_process";
import { run } from "./program.mjs";

const machines = fileURLToPath(new URL("../../machines", import.meta.url));
export const begin = 1_772_352_000;  // s since 1970: 1 March 2026, 8:00 UTC

/** A simulated log whose times count from 1970. */
export function simulate(path, name, start, words) {
  run(["simulate", "press", "--out", "plain.csv", ...words], path);
  const [head, ...rows] = readFileSync(join(path, "plain.csv"), "utf8").trimEnd().split("\n");
  const dated = rows.map((row) => { const comma = row.indexOf(","); return (Number(row.slice(0, comma)) + start).toFixed(4) + row.slice(comma); });
  writeFileSync(join(path, name), [head, ...dated].join("\n") + "\n");
}

/** press.toml with rules that learn from 100 strokes, and press.db: 108 healthy strokes, 43 with a leak after a break. */
export function makeHistory(path) {
  if (process.env.HYDROSCOPE_HISTORY) return cpSync(process.env.HYDROSCOPE_HISTORY, path, { recursive: true });
  writeFileSync(join(path, "press.toml"), readFileSync(join(machines, "die_cushion.toml")));
  writeFileSync(join(path, "press_rules.toml"), readFileSync(join(machines, "die_cushion_rules.toml"), "utf8").replace("commissioning = 1500", "commissioning = 100"));
  simulate(path, "early.csv", begin, ["--seconds", "650", "--seed", "1", "--oil", "30:45"]);
  simulate(path, "late.csv", begin + 1_400, ["--seconds", "260", "--seed", "2", "--oil", "31:46", "--effect", "internal_leakage=3e-12"]);
  run(["replay", "early.csv", "late.csv", "--machine", "press.toml", "--db", "press.db"], path);
}

/** The same as NAME.db, with its journal. */
export function copyHistory(path, name) {
  for (const part of ["", ".alarms"]) cpSync(join(path, `press${part}.db`), join(path, `${name}${part}.db`));
}

/** Valve checks of four years as a service stores them: the pilot stage grows slow, the last sweep was refused. */
export function addValveChecks(path) {
  const rows = Array.from({ length: 16 }, (_, k) => {
    const f0 = 82 - 1.6 * k, year = 365.25 * 86_400, time = begin + 1_000 - (15 - k) * year / 4;
    return `(1, ${k}, ${time}, 'measured', '16 frequencies, 16.4 s recorded', ${f0}, 0.9, ${0.72 + 0.012 * k}, 0.02, 1.0, 0.004, 0.0018, 0.0001, ${1.05 * f0}, 1.4, 0.1, 7e6, ${313 + (k % 3)})`;
  });
  rows.push(`(1, 16, ${begin + 90_000}, 'refused', 'the controller refused: the machine is working or another sweep runs', ${new Array(13).fill("NULL").join(", ")})`);
  sqlite(path, "press.db", `INSERT INTO valve_check SELECT * FROM (VALUES ${rows.join(", ")})`);
}

/** learning.db: the first 19 or so strokes of the same press. */
export function makeBeginning(path) {
  simulate(path, "begin.csv", begin, ["--seconds", "120", "--seed", "3", "--oil", "30:40"]);
  run(["replay", "begin.csv", "--machine", "press.toml", "--db", "learning.db"], path);
}

/** tank.toml, a machine with states, and tank.db: 40 episodes of a tank whose outlet clogs from the 30th on. */
export function makeEpisodes(path) {
  const episode = 100, seen = ["t,u,y"];
  let seed = 1, h = 4, u = 3;
  const random = () => (seed = (seed * 16_807) % 2_147_483_647) / 2_147_483_647;
  for (let row = 0; row < 40 * episode; ++row) {
    if (row % 20 === 0) u = 1 + 4 * random();
    seen.push(`${row},${u.toFixed(3)},${(h + 0.03 * (random() + random() + random() - 1.5)).toFixed(5)}`);
    const outlet = 0.3 * (1 - 0.01 * Math.max(0, row / episode - 30));
    for (let step = 0; step < 20; ++step) h += 0.05 * (0.2 * u - outlet * Math.sqrt(Math.max(0, h)));
  }
  writeFileSync(join(path, "tank.csv"), seen.join("\n") + "\n");
  writeFileSync(join(path, "tank.toml"), `[machine]
name = "tank"
[log]
hold = "zero"
time = { column = "t", unit = "s" }
[signals]
u = { column = "u", unit = "V" }
level = { column = "y", unit = "V" }
[states]
h = { ddt = "pump*u - k*sqrt(max(h, 0))", min = 0 }
[outputs]
level = "h"
[episodes]
seconds = ${episode}
[parameters]
k = { start = 0.1, min = 0.01, max = 2 }
pump = { start = 0.1, min = 0.01, max = 2 }
`);
  run(["replay", "tank.csv", "--machine", "tank.toml", "--db", "tank.db"], path);
}

/** fleet.db: twelve axes of three presses with half a minute of strokes each, and alarms as that of press.db (makeHistory) at nine. */
export function makeFleet(path) {
  const text = readFileSync(join(path, "press.toml"), "utf8");
  simulate(path, "fleet.csv", begin, ["--seconds", "30", "--seed", "3", "--oil", "30:40"]);
  const axes = ["Presse_Nord", "Presse_Sued_mit_langem_Namen", "P3"].flatMap((press) => [1, 2, 3, 4].map((axis) => `${press}/Kissen_${axis}`));
  for (const axis of axes) {
    writeFileSync(join(path, "fleet.toml"), text.replace('name = "die_cushion"', `name = "${axis}"`));
    run(["replay", "fleet.csv", "--machine", "fleet.toml", "--db", "fleet.db"], path);
  }
  const alarms = axes.filter((_, k) => k % 4 !== 0).map((axis, k) =>
    `UPDATE one SET machine = '${axis}', severity = '${["advisory", "warning", "alarm"][k % 3]}', acknowledged = ${k % 2}; INSERT INTO alarm SELECT * FROM one;`);
  sqlite(path, "fleet.alarms.db", `ATTACH 'press.alarms.db' AS press; CREATE TEMP TABLE one AS SELECT * FROM press.alarm WHERE id = 'internal_leakage'; ${alarms.join(" ")}`);
}

function sqlite(path, database, statement) {
  const done = spawnSync("sqlite3", [database, statement], { cwd: path, encoding: "utf8" });
  if (done.status !== 0) throw new Error(`sqlite3: ${done.stderr}`);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  rmSync(process.argv[2], { recursive: true, force: true });
  mkdirSync(process.argv[2], { recursive: true });
  makeHistory(process.argv[2]);
}
