// What a trend's picture draws, in the unit people read.

import { inUnit } from "./shown";
import { gapsAfter, middle, type AxisKind } from "./trend_axis";
import type { MaybeNumber, Trend, WatchedUnit } from "./watch_types";

/** A place of the axis each; null where there is no value, or where the line is broken. */
export interface Courses { x: number[]; low: MaybeNumber[]; high: MaybeNumber[]; below: MaybeNumber[]; above: MaybeNumber[]; mean: MaybeNumber[]; healthy: MaybeNumber[] }

/** A bin without values, or one that stands for a gap, is null. `compensated`: without what the oil temperature accounts for. */
export function coursesOf(trend: Trend, unit: WatchedUnit, axis: AxisKind, compensated: boolean): Courses {
  const { bins, healthy } = trend;
  const out: Courses = { x: [], low: [], high: [], below: [], above: [], mean: [], healthy: [] };
  const gaps = axis === "time" ? gapsAfter(trend) : new Set<number>();
  const shown = (value: MaybeNumber, k: number) =>
    inUnit(value === null ? null : value - (compensated ? (healthy?.by_oil[k] ?? NaN) : 0), unit);
  const finite = (value: MaybeNumber) => (value === null || !Number.isFinite(value) ? null : value);
  bins.first.forEach((_, k) => {
    const mean = finite(shown(bins.mean[k], k)), half = 1.96 * (bins.std[k] ?? NaN) * Math.abs(unit.factor);
    out.x.push(middle(bins, k, axis));
    out.mean.push(mean);
    const ends = [finite(shown(bins.low[k], k)), finite(shown(bins.high[k], k))];
    out.low.push(ends[0]);
    out.high.push(ends[1]);
    out.below.push(mean === null ? null : finite(mean - half));
    out.above.push(mean === null ? null : finite(mean + half));
    out.healthy.push(healthy ? finite(shown(healthy.value[k], k)) : null);
    if (!gaps.has(k)) return;
    out.x.push(bins.end_s[k]! + 1e-3);
    for (const list of [out.low, out.high, out.below, out.above, out.mean, out.healthy]) list.push(null);
  });
  return out;
}
