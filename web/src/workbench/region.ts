// A part of the operating space, chosen on the map: "p_A:33.4:85|y_v:20:25", in the units of the program.

import { useEffect, useState } from "preact/hooks";
import { find } from "../api";
import { useStore } from "../store";
import type { ErrorMap, RegionErrors, StrokePicture } from "../types";
import { amount, nameOf, short, shownNumber } from "../units";
import { useWords } from "../words";
import type { Words } from "../words/en";

export interface Range { signal: string; from: number; to: number }

export function regionOf(text: string | undefined): Range[] {
  return (text ?? "").split("|").map((part) => part.split(":"))
    .filter((part) => part.length === 3 && Number.isFinite(Number(part[1])) && Number.isFinite(Number(part[2])))
    .map(([signal, from, to]) => ({ signal, from: Number(from), to: Number(to) }));
}

export function regionText(region: Range[]): string {
  return region.map(({ signal, from, to }) => `${signal}:${from}:${to}`).join("|");
}

/** Signals that the program works out, beside those of the machine. */
const workedOut: Record<string, keyof Words> = { speed: "signalSpeed", pressure_rate: "signalPressureRate", phase: "signalPhase" };

/** What a signal is called: those of the machine as in its file, others in words of the page. */
export function useSignalName(): (signal: string) => string {
  const say = useWords();
  const own = useStore().session?.machine?.signals ?? [];
  return (signal) => (workedOut[signal] && !own.includes(signal) ? say(workedOut[signal]) : signal);
}

/** "p_A 33.4 … 85 bar" */
export function useRangeWords(): (range: Range, unit: string) => string {
  const nameOf = useSignalName();
  return ({ signal, from, to }, unit) => `${nameOf(signal)} ${short(shownNumber(from, unit))} … ${amount(to, unit)}`;
}

/** The same of a region, with the units that the maps name. */
export function useRegionWords(): (region: Range[], maps: ErrorMap[]) => string {
  const rangeWords = useRangeWords();
  const unitOf = (signal: string, maps: ErrorMap[]) => maps.map((map) => map.units[map.signals.indexOf(signal)]).find((unit) => unit) ?? "";
  return (region, maps) => region.map((range) => rangeWords(range, unitOf(range.signal, maps))).join(", ");
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
