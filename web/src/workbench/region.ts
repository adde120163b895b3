// A part of the operating space, chosen on the map: "p_A:33.4:85|y_v:20:25", in the units of the program.

import { useEffect, useState } from "preact/hooks";
import { find } from "../api";
import type { ErrorMap, RegionErrors, StrokePicture } from "../types";
import { amount, nameOf, short, shownNumber } from "../units";

export interface Range { signal: string; from: number; to: number }

export function regionOf(text: string | undefined): Range[] {
  return (text ?? "").split("|").map((part) => part.split(":"))
    .filter((part) => part.length === 3 && Number.isFinite(Number(part[1])) && Number.isFinite(Number(part[2])))
    .map(([signal, from, to]) => ({ signal, from: Number(from), to: Number(to) }));
}

export function regionText(region: Range[]): string {
  return region.map(({ signal, from, to }) => `${signal}:${from}:${to}`).join("|");
}

/** "p_A 33.4 … 85 bar" */
export function rangeWords({ signal, from, to }: Range, unit: string): string {
  return `${signal} ${short(shownNumber(from, unit))} … ${amount(to, unit)}`;
}

/** The same of a region, with the units that the maps name. */
export function regionWords(region: Range[], maps: ErrorMap[]): string {
  const unitOf = (signal: string) => maps.map((map) => map.units[map.signals.indexOf(signal)]).find((unit) => unit) ?? "";
  return region.map((range) => rangeWords(range, unitOf(range.signal))).join(", ");
}

/** "p_A (bar)" */
export const axisName = (signal: string, unit: string) => `${signal}${nameOf(unit) && ` (${nameOf(unit)})`}`;

/** How the model of this version errs in the region; null without a region, or until it is known. `ready` changes when more is. */
export function useRegionErrors(text: string | undefined, version: number, ready: unknown): RegionErrors | null {
  const [found, setFound] = useState<RegionErrors | null>(null);
  useEffect(() => {
    if (!text) return setFound(null);
    let wanted = true;
    find<RegionErrors>("region", { where: text, version }).catch(() => null).then((errors) => { if (wanted) setFound(errors); });
    return () => { wanted = false; };
  }, [text, version, ready]);
  return text ? found : null;
}

/** Whether each window of a stroke lies in the region. */
export function insideOf(picture: StrokePicture, region: Range[]): boolean[] {
  return picture.measured.map((_, w) => region.every(({ signal, from, to }) => {
    const value = picture.signals.find((s) => s.name === signal)?.values[w];
    return value !== undefined && value >= from && value <= to;
  }));
}

/** Stretches of a stroke (s from its begin) that lie in the region. */
export function stretchesIn(picture: StrokePicture, inside: boolean[]): { from: number; to: number }[] {
  const stretches: { from: number; to: number }[] = [];
  inside.forEach((is, w) => {
    if (!is) return;
    const begin = (w - 0.5) * picture.step, end = (w + 0.5) * picture.step, last = stretches[stretches.length - 1];
    if (last && begin - last.to < picture.step / 2) last.to = end;
    else stretches.push({ from: begin, to: end });
  });
  return stretches;
}
