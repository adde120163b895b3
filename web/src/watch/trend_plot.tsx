// One parameter over time or strokes: course, 95 % band, lowest and highest, healthy value, limits, marks. Drawn by uPlot;
// cursors of plots with the same axis move together.

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { pageColor } from "../plot";
import { amount, short } from "../units";
import { useWords } from "../words";
import { dateText, inUnit, ofParameter, symbolOf } from "./shown";
import { gapsAfter, middle, placeOf, strokeAt, tickTexts, type AxisKind } from "./trend_axis";
import type { Mark, MaybeNumber, Trend, WatchedUnit } from "./watch_types";

export const markColors: Record<Mark["kind"], string> = {
  alarm: "--bad", cleared: "--good", reference: "--line-a", model: "--accent", valve_check: "--noise",
};

const markKinds = Object.keys(markColors) as Mark["kind"][];  // each writes on a line of its own

interface Props {
  trend: Trend;
  unit: WatchedUnit;
  axis: Exclude<AxisKind, "oil">;
  compensated: boolean;
  from: number;  // strokes that are looked at
  to: number;
  look: (from: number, to: number) => void;
  height: number;
}

interface Courses { x: number[]; low: MaybeNumber[]; high: MaybeNumber[]; below: MaybeNumber[]; above: MaybeNumber[]; mean: MaybeNumber[]; healthy: MaybeNumber[] }

/** What is drawn, in the unit people read; a bin without values, or one that stands for a gap, is null. */
function coursesOf({ trend, unit, axis, compensated }: Props): Courses {
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

export function TrendPlot(props: Props) {
  const say = useWords();
  const box = useRef<HTMLDivElement>(null);
  const readout = useRef<HTMLParagraphElement>(null);
  const { trend, unit, axis, compensated, from, to, look, height } = props;
  useEffect(() => {
    const place = box.current;
    if (!place || trend.bins.first.length === 0) return;
    const courses = coursesOf(props);
    const at = (stroke: number) => placeOf(stroke, trend, axis);
    const range: [number, number] = [at(from), Math.max(at(to - 1), at(from) + 1e-6)];
    const name = `${symbolOf(unit)}${unit.name ? ` (${unit.name})` : ""}`;
    let late = 0;
    const commit = (plot: uPlot) => {  // asks for what is looked at now, once it stands still
      clearTimeout(late);
      late = window.setTimeout(() => {
        const { min, max } = plot.scales.x;
        if (min === undefined || max === undefined || min === null || max === null) return;
        if (Math.abs(min - range[0]) < 1e-9 && Math.abs(max - range[1]) < 1e-9) return;
        look(strokeAt(min, trend, axis), strokeAt(max, trend, axis) + 1);
      }, 160);
    };
    const move = (plot: uPlot, centre: number, scale: number, shift: number) => {
      const min = plot.scales.x.min!, max = plot.scales.x.max!, span = max - min;
      plot.setScale("x", { min: centre - (centre - min) * scale + shift * span, max: centre + (max - centre) * scale + shift * span });
      commit(plot);
    };
    const marks = (plot: uPlot) => {
      const { ctx, bbox } = plot;
      ctx.save();
      ctx.lineWidth = 2;
      for (const mark of trend.marks) {
        const x = plot.valToPos(at(mark.stroke), "x", true);
        if (x < bbox.left || x > bbox.left + bbox.width) continue;
        ctx.strokeStyle = ctx.fillStyle = pageColor(markColors[mark.kind]);
        ctx.setLineDash(mark.kind === "alarm" ? [] : [6, 4]);
        ctx.beginPath();
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + bbox.height);
        ctx.stroke();
        ctx.font = `${12 * devicePixelRatio}px system-ui`;
        ctx.fillText({ alarm: "▲", cleared: "△", reference: "R", model: "M", valve_check: "V" }[mark.kind], x + 3, bbox.top + (12 + 14 * markKinds.indexOf(mark.kind)) * devicePixelRatio);
      }
      ctx.setLineDash([2, 4]);
      ctx.strokeStyle = pageColor("--bad");
      for (const limit of trend.limits) {
        const y = plot.valToPos(inUnit(limit.value, unit)!, "y", true);
        if (y < bbox.top || y > bbox.top + bbox.height) continue;
        ctx.beginPath();
        ctx.moveTo(bbox.left, y);
        ctx.lineTo(bbox.left + bbox.width, y);
        ctx.stroke();
      }
      ctx.restore();
    };
    const tell = (plot: uPlot) => {
      const k = plot.cursor.idx;
      if (!readout.current) return;
      if (k === null || k === undefined || courses.mean[k] === null) { readout.current.textContent = ""; return; }
      const bin = Math.max(0, trend.bins.first.findIndex((_, b) => middle(trend.bins, b, axis) >= courses.x[k]));
      const { first, last, std, oil_temperature_K } = trend.bins, oil = oil_temperature_K[bin];
      const si = (courses.mean[k]! - unit.offset) / unit.factor;
      readout.current.textContent = [
        axis === "time" ? dateText(courses.x[k]) : "",
        first[bin] === last[bin] ? say("strokeNumber", { stroke: first[bin] }) : say("strokeNumbers", { from: first[bin], to: last[bin] }),
        `${symbolOf(unit)} ${ofParameter(si, std[bin], unit)}`, oil === null ? "" : `${say("oil")} ${amount(oil - 273.15, "°C")}`,
      ].filter((part) => part !== "").join(" · ");
    };
    const line = { stroke: pageColor("--grid"), width: 1 };
    const look_of = { stroke: pageColor("--text"), grid: line, ticks: line, font: "12px system-ui", labelFont: "12px system-ui" };
    const draw = () => new uPlot({
      width: Math.max(240, place.clientWidth), height,
      scales: { x: { time: axis === "time", min: range[0], max: range[1] } },
      axes: [
        { ...look_of, size: 46, space: 96, label: axis === "time" ? undefined : say("stroke"), labelSize: 18,
          values: (_, ticks, _a, _s, step) => (axis === "time" ? tickTexts(ticks, step) : ticks.map((tick) => tick.toLocaleString())) },
        { ...look_of, size: 62, label: name, labelSize: 20, values: (_, ticks) => ticks.map((tick) => short(tick, 5)) },
      ],
      series: [
        {}, ...(["low", "high", "below", "above"] as const).map(() => ({ width: 0, points: { show: false } })),  // edges of bands alone
        { stroke: pageColor("--line-a"), width: 1.8, points: { show: courses.x.length < 80, size: 5 } },
        { stroke: pageColor("--good"), width: 1.6, dash: [6, 4], points: { show: false } },
      ],
      bands: [{ series: [4, 3], fill: pageColor("--band") }, { series: [2, 1], fill: pageColor("--range") }],
      legend: { show: false },
      cursor: { drag: { x: true, y: false, setScale: true }, sync: { key: `trend-${axis}` } },
      hooks: { draw: [marks], setCursor: [tell], setSelect: [(plot) => { if (plot.select.width > 0) commit(plot); }] },
    }, [courses.x, courses.low, courses.high, courses.below, courses.above, courses.mean, courses.healthy] as uPlot.AlignedData, place);
    let plot = draw();
    plot.setScale("x", { min: range[0], max: range[1] });
    const wheel = (event: WheelEvent) => {
      if (!event.ctrlKey && !event.shiftKey && !event.metaKey) return;  // else the page scrolls
      event.preventDefault();
      const delta = event.deltaY || event.deltaX;
      const centre = plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x");
      if (event.shiftKey) move(plot, centre, 1, 0.1 * Math.sign(delta)); else move(plot, centre, delta > 0 ? 1.25 : 0.8, 0);
    };
    const key = (event: KeyboardEvent) => {
      const centre = (plot.scales.x.min! + plot.scales.x.max!) / 2;
      const moves: Record<string, () => void> = {
        ArrowLeft: () => move(plot, centre, 1, -0.2), ArrowRight: () => move(plot, centre, 1, 0.2),
        "+": () => move(plot, centre, 0.6, 0), "-": () => move(plot, centre, 1 / 0.6, 0), "0": () => look(0, trend.strokes),
      };
      if (!moves[event.key]) return;
      event.preventDefault();
      moves[event.key]();
    };
    const all = () => look(0, trend.strokes);
    let width = place.clientWidth;
    const resized = new ResizeObserver(() => {
      if (Math.abs(place.clientWidth - width) < 2) return;
      width = place.clientWidth;
      plot.setSize({ width: Math.max(240, width), height });
    });
    const again = () => { plot.destroy(); plot = draw(); plot.setScale("x", { min: range[0], max: range[1] }); };
    resized.observe(place);
    place.addEventListener("wheel", wheel, { passive: false });
    place.addEventListener("keydown", key);
    place.addEventListener("dblclick", all);
    addEventListener("themechange", again);
    return () => {
      clearTimeout(late);
      resized.disconnect();
      place.removeEventListener("wheel", wheel);
      place.removeEventListener("keydown", key);
      place.removeEventListener("dblclick", all);
      removeEventListener("themechange", again);
      plot.destroy();
    };
  }, [trend, unit, axis, compensated, from, to, height, say]);
  return (
    <div class="trend-plot">
      <div ref={box} tabIndex={0} role="application" aria-label={`${symbolOf(unit)}: ${say("trendKeys")}`} />
      <p ref={readout} class="readout" aria-live="off" />
    </div>
  );
}
