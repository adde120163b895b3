// A part of the operating space, chosen on the map: "p_A:33.4:85|y_v:20:25".

import type { StrokePicture } from "../types";

export interface Range { signal: string; from: number; to: number }

export function regionOf(text: string | undefined): Range[] {
  return (text ?? "").split("|").map((part) => part.split(":"))
    .filter((part) => part.length === 3 && Number.isFinite(Number(part[1])) && Number.isFinite(Number(part[2])))
    .map(([signal, from, to]) => ({ signal, from: Number(from), to: Number(to) }));
}

export function regionText(region: Range[]): string {
  return region.map(({ signal, from, to }) => `${signal}:${from}:${to}`).join("|");
}

/** Stretches of a stroke (s from its begin) that lie in the region. */
export function stretchesIn(picture: StrokePicture, region: Range[]): { from: number; to: number }[] {
  if (region.length === 0) return [];
  const stretches: { from: number; to: number }[] = [];
  for (let w = 0; w < picture.measured.length; ++w) {
    const inside = region.every(({ signal, from, to }) => {
      const value = picture.signals.find((s) => s.name === signal)?.values[w];
      return value !== undefined && value >= from && value <= to;
    });
    if (!inside) continue;
    const begin = (w - 0.5) * picture.step, end = (w + 0.5) * picture.step, last = stretches[stretches.length - 1];
    if (last && begin - last.to < picture.step / 2) last.to = end;
    else stretches.push({ from: begin, to: end });
  }
  return stretches;
}
