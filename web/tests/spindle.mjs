// A log of a machine of one's own, with a German logger's columns: a cylinder whose force is that of its oil, less friction.

import { writeFileSync } from "node:fs";
import { join } from "node:path";

/** NAME in the folder: a minute, 100 rows a second, with decimal commas. */
export function makeSpindle(path, name = "spindel.csv") {
  let seed = 11;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647 - 0.5;
  const rows = Array.from({ length: 6000 }, (_, k) => {
    const time = k * 0.01, speed = Math.cos(0.9 * time), pressure = 90 + 40 * Math.sin(0.5 * time);
    return [time.toFixed(2), (pressure * 400 - 1500 * Math.sign(speed) + 10 * random()).toFixed(2), (pressure + 0.05 * random()).toFixed(4), ((100 + (30 / 0.9) * Math.sin(0.9 * time) + 0.02 * random())).toFixed(4)].join(";").replaceAll(".", ",");
  });
  writeFileSync(join(path, name), ["Zeit_s;Kolbenkraft [N];Oeldruck [bar];Hubweg [mm]", ...rows].join("\n"));
}
