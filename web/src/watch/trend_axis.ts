// Between strokes, which the program counts in, and the axis one looks at: times where they are dates, else strokes.

import type { Bins, Trend } from "./watch_types";

export type AxisKind = "time" | "stroke" | "oil";

export function middle(bins: Bins, k: number, axis: AxisKind): number {
  if (axis === "time") return ((bins.begin_s[k] ?? NaN) + (bins.end_s[k] ?? NaN)) / 2;
  return (bins.first[k] + bins.last[k]) / 2;
}

/** Place on the axis of a stroke, between the bins around it. */
export function placeOf(stroke: number, trend: Trend, axis: AxisKind): number {
  if (axis !== "time") return stroke;
  const { first, last, begin_s, end_s } = trend.bins;
  if (first.length === 0) return 0;
  let low = 0, high = first.length - 1;
  while (low < high) {
    const half = (low + high) >> 1;
    if (last[half] < stroke) low = half + 1; else high = half;
  }
  const begin = begin_s[low] ?? 0, end = end_s[low] ?? begin, count = last[low] - first[low];
  return begin + (count > 0 ? Math.min(1, Math.max(0, (stroke - first[low]) / count)) * (end - begin) : 0);
}

/** Stroke at a place of the axis. */
export function strokeAt(place: number, trend: Trend, axis: AxisKind): number {
  const { first, last, begin_s, end_s } = trend.bins;
  if (first.length === 0) return 0;
  if (axis !== "time") return Math.round(place);
  let low = 0, high = first.length - 1;
  while (low < high) {
    const half = (low + high) >> 1;
    if ((end_s[half] ?? 0) < place) low = half + 1; else high = half;
  }
  const begin = begin_s[low] ?? 0, end = end_s[low] ?? begin;
  const share = end > begin ? Math.min(1, Math.max(0, (place - begin) / (end - begin))) : 0;
  return Math.round(first[low] + share * (last[low] - first[low]));
}

/** Bins between which time passes without strokes: the line is broken there. */
export function gapsAfter(trend: Trend): Set<number> {
  const { begin_s, end_s } = trend.bins;
  const between: number[] = [];
  for (let k = 1; k < begin_s.length; ++k) between.push((begin_s[k] ?? 0) - (end_s[k - 1] ?? 0));
  const lengths = begin_s.map((begin, k) => (end_s[k] ?? 0) - (begin ?? 0));
  const typical = [...between].sort((a, b) => a - b)[between.length >> 1] ?? 0;
  const length = [...lengths].sort((a, b) => a - b)[lengths.length >> 1] ?? 0;
  return new Set(between.flatMap((gap, k) => (gap > 10 * Math.max(typical, 1) && gap > length ? [k] : [])));
}

/** "14:05", "3 Mar 14:05", "3 Mar", "Mar 2026": as fine as the ticks stand apart. */
export function tickTexts(ticks: number[], step: number): string[] {
  const language = document.documentElement.lang || "en";
  const format = (options: Intl.DateTimeFormatOptions) => new Intl.DateTimeFormat(language, options);
  const day = format({ day: "numeric", month: "short" }), month = format({ month: "short", year: "numeric" });
  const time = format({ hour: "2-digit", minute: "2-digit", ...(step < 60 ? { second: "2-digit" as const } : {}) });
  return ticks.map((tick, k) => {
    const date = new Date(1000 * tick);
    if (step >= 27 * 86_400) return month.format(date);
    if (step >= 86_400) return day.format(date);
    const new_day = k === 0 || new Date(1000 * ticks[k - 1]).getDate() !== date.getDate();
    return new_day ? `${day.format(date)}\n${time.format(date)}` : time.format(date);
  });
}
