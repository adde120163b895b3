// One parameter over time or strokes, drawn by uPlot: course, 95 % band, lowest and highest, healthy value, limits, marks. Moved by
// wheel, keys and dragging, a frame at a time; cursors of views with the same axis move together.

import uPlot from "uplot";
import { axisLook, pageColor } from "../plot";
import { amount, grouped, short, unitName } from "../units";
import type { Say } from "../words";
import { CourseStrip } from "./course_strip";
import { dateText, inUnit, isDate, ofParameter, symbolOf } from "./shown";
import { middle, placeOf, strokeAt, tickTexts, type AxisKind } from "./trend_axis";
import { coursesOf, type Courses } from "./trend_courses";
import type { Mark, Trend, WatchedUnit } from "./watch_types";

export const markColors: Record<Mark["kind"], string> = {
  alarm: "--bad", cleared: "--good", reference: "--line-a", model: "--accent", valve_check: "--noise",
};
const markLetters: Record<Mark["kind"], string> = { alarm: "▲", cleared: "△", reference: "R", model: "M", valve_check: "V" };
const markKinds = Object.keys(markColors) as Mark["kind"][];  // each writes on a line of its own

const stillness = 160;  // ms after which what is looked at counts as chosen
const aheadOf = 0.4;    // widths of the view that are there on each side of it before more is asked for

const pixelsOfLine = 16;        // of a wheel that counts lines
const zoomOfPixel = 0.0022;    // so that a notch of 100 pixels zooms by a quarter

/** What a view shows and whom it tells. */
export interface TrendLook {
  trend: Trend;
  compensated: boolean;
  from: number;  // strokes that are looked at
  to: number;
  /** Chosen, once it stands still. */
  look: (from: number, to: number) => void;
  /** Come near while it moves: values of these strokes and beside them will be needed. */
  ahead: (from: number, to: number) => void;
}

/** Of the axis of values: fits what is in view, but only grows while one pans, so that the strip need not be drawn anew. */
class Heights {
  held: [number, number] | null = null;
  moving = false;

  range(low: number | null, high: number | null): [number, number] {
    if (low === null || high === null) return this.held ?? [0, 1];
    if (this.moving && this.held && low >= this.held[0] && high <= this.held[1]) return this.held;
    const [bottom, top] = uPlot.rangeNum(low, high, 0.1, true) as [number, number];
    if (!this.moving || !this.held) return (this.held = [bottom, top]);
    const room = (top - bottom) / 2;
    return (this.held = [low < this.held[0] ? bottom - room : this.held[0], high > this.held[1] ? top + room : this.held[1]]);
  }
}

export class TrendView {
  private plot: uPlot;
  private now: TrendLook;
  private courses: Courses;
  private strip!: CourseStrip;
  private readonly heights = new Heights();
  private colors!: Record<Mark["kind"], string>;
  private width: number;
  private next: { min: number; max: number } | null = null;  // to be shown with the next frame
  private frame = 0;
  private late = 0;
  private asked: [number, number] = [0, 0];
  private readonly resized: ResizeObserver;

  constructor(private readonly place: HTMLElement, private readonly readout: HTMLElement | null, private readonly unit: WatchedUnit,
    private readonly axis: Exclude<AxisKind, "oil">, private readonly height: number, private readonly say: Say, first: TrendLook) {
    this.now = first;
    this.courses = this.newCourses();
    this.width = place.clientWidth;
    this.plot = this.draw();
    this.show(first);
    this.resized = new ResizeObserver(() => this.resize());
    this.resized.observe(place);
    place.addEventListener("wheel", this.wheel, { passive: false });
    place.addEventListener("keydown", this.key);
    place.addEventListener("dblclick", this.all);
    addEventListener("themechange", this.again);
  }

  destroy(): void {
    clearTimeout(this.late);
    cancelAnimationFrame(this.frame);
    this.resized.disconnect();
    this.place.removeEventListener("wheel", this.wheel);
    this.place.removeEventListener("keydown", this.key);
    this.place.removeEventListener("dblclick", this.all);
    removeEventListener("themechange", this.again);
    this.plot.destroy();
  }

  /** Other values, or others of them; while it is being moved it stays where it is. */
  show(look: TrendLook): void {
    this.now = look;
    this.courses = this.newCourses();
    const { x, low, high, below, above, mean, healthy } = this.courses;
    this.plot.setData([x, low, high, below, above, mean, healthy] as uPlot.AlignedData, false);
    this.asked = [look.trend.first, look.trend.end];
    const { min, max } = this.plot.scales.x;
    this.plot.setScale("x", this.heights.moving ? { min: min!, max: max! } : this.chosen());
    if (!this.heights.moving && (look.from < look.trend.first || look.to > look.trend.end)) look.ahead(look.from, look.to);
  }

  private newCourses(): Courses {
    const courses = coursesOf(this.now.trend, this.unit, this.axis, this.now.compensated);
    this.strip = new CourseStrip(courses, { range: pageColor("--range"), band: pageColor("--band"), mean: pageColor("--line-a"), healthy: pageColor("--good") });
    return courses;
  }

  private at(stroke: number): number { return placeOf(stroke, this.now.trend, this.axis); }

  private chosen(): { min: number; max: number } {
    const min = this.at(this.now.from);
    return { min, max: Math.max(this.at(this.now.to - 1), min + 1e-6) };
  }

  private draw(): uPlot {
    const { unit, axis, say } = this;
    this.colors = Object.fromEntries(markKinds.map((kind) => [kind, pageColor(markColors[kind])])) as Record<Mark["kind"], string>;
    const bad = pageColor("--bad");
    const none = { paths: () => null, points: { show: false } };  // the strip draws them
    return new uPlot({
      width: Math.max(240, this.place.clientWidth), height: this.height,
      scales: { x: { time: axis === "time", ...this.chosen() }, y: { range: (_, low, high) => this.heights.range(low, high) } },
      axes: [
        { ...axisLook(), size: 46, space: 96, label: axis === "time" ? undefined : say("stroke"), labelSize: 18,
          values: (_, ticks, _a, _s, step) => (axis === "time" ? tickTexts(ticks, step) : ticks.map((tick) => grouped(tick))) },
        { ...axisLook(), size: 62, label: `${symbolOf(unit)}${unitName(unit) && ` (${unitName(unit)})`}`, labelSize: 20, values: (_, ticks) => ticks.map((tick) => short(tick, 5)) },
      ],
      series: [{}, none, none, none, none,
        { ...none, stroke: pageColor("--line-a"), points: { show: () => this.courses.x.length < 80, size: 5 } }, none],
      legend: { show: false },
      cursor: { drag: { x: true, y: false, setScale: true }, sync: { key: `trend-${axis}` } },
      hooks: {
        drawAxes: [(plot) => this.strip.copyTo(plot)], draw: [(plot) => this.drawMarks(plot, bad)],
        setCursor: [(plot) => this.tell(plot)], setSelect: [(plot) => { if (plot.select.width > 0) this.commitLater(); }],
      },
    }, [[], [], [], [], [], [], []] as uPlot.AlignedData, this.place);
  }

  private drawMarks(plot: uPlot, bad: string): void {
    const { ctx, bbox } = plot, { trend } = this.now;
    ctx.save();
    ctx.lineWidth = 2;
    ctx.font = `${12 * devicePixelRatio}px system-ui`;
    ctx.textAlign = "left";
    for (const mark of trend.marks) {
      const x = plot.valToPos(this.axis === "time" && isDate(mark.time_s) ? Math.min(mark.time_s, plot.scales.x.max!) : this.at(Math.min(mark.stroke, trend.strokes - 1)), "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      ctx.strokeStyle = ctx.fillStyle = this.colors[mark.kind];
      ctx.setLineDash(mark.kind === "alarm" ? [] : [6, 4]);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.fillText(markLetters[mark.kind], x + 3, bbox.top + (12 + 14 * markKinds.indexOf(mark.kind)) * devicePixelRatio);
    }
    ctx.setLineDash([2, 4]);
    ctx.strokeStyle = bad;
    for (const limit of trend.limits) {
      const y = plot.valToPos(inUnit(limit.value, this.unit)!, "y", true);
      if (y < bbox.top || y > bbox.top + bbox.height) continue;
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
    ctx.restore();
  }

  /** What stands under the cursor, in words. */
  private tell(plot: uPlot): void {
    const { courses, unit, axis, say } = this, { trend } = this.now, k = plot.cursor.idx;
    if (!this.readout) return;
    if (k === null || k === undefined || courses.mean[k] == null) { if (this.readout.textContent !== "") this.readout.textContent = ""; return; }
    const bin = Math.max(0, trend.bins.first.findIndex((_, b) => middle(trend.bins, b, axis) >= courses.x[k]));
    const { first, last, std, oil_temperature_K } = trend.bins, oil = oil_temperature_K[bin];
    const si = (courses.mean[k]! - unit.offset) / unit.factor;
    this.readout.textContent = [
      axis === "time" ? dateText(courses.x[k]) : "",
      first[bin] === last[bin] ? say("strokeNumber", { stroke: first[bin] }) : say("strokeNumbers", { from: first[bin], to: last[bin] }),
      `${symbolOf(unit)} ${ofParameter(si, std[bin], unit)}`, oil === null ? "" : `${say("oil")} ${amount(oil - 273.15, "°C")}`,
    ].filter((part) => part !== "").join(" · ");
  }

  /** Asks for what is looked at now, once it stands still. */
  private commitLater(): void {
    clearTimeout(this.late);
    this.late = window.setTimeout(() => {
      this.heights.moving = false;
      const { min, max } = this.plot.scales.x, { trend } = this.now, chosen = this.chosen();
      if (min == null || max == null) return;
      if (Math.abs(min - chosen.min) < 1e-9 && Math.abs(max - chosen.max) < 1e-9) return;
      this.plot.setScale("x", { min, max });  // heights that fit again
      this.now.look(strokeAt(min, trend, this.axis), strokeAt(max, trend, this.axis) + 1);
    }, stillness);
  }

  /** Scales the view about a place and shifts it by a share of its width, with the next frame; several moves of one frame are one. */
  private move(centre: number, scale: number, shift: number): void {
    const { min, max } = this.next ?? { min: this.plot.scales.x.min!, max: this.plot.scales.x.max! }, span = max - min;
    this.next = this.within({ min: centre - (centre - min) * scale + shift * span, max: centre + (max - centre) * scale + shift * span }, scale === 1);
    this.heights.moving = scale === 1;
    if (this.frame === 0) this.frame = requestAnimationFrame(() => this.apply());
    this.commitLater();
  }

  /** Panning ends with the first and the last stroke. */
  private within(view: { min: number; max: number }, pans: boolean): { min: number; max: number } {
    const { first, end, strokes } = this.now.trend;
    if (!pans) return view;
    const low = first === 0 ? this.at(0) : -Infinity, high = end >= strokes ? this.at(strokes - 1) : Infinity;
    const back = Math.max(0, low - view.min) || Math.min(0, high - view.max);
    return { min: view.min + back, max: view.max + back };
  }

  private apply(): void {
    this.frame = 0;
    if (!this.next) return;
    const view = this.next, { trend } = this.now;
    this.next = null;
    this.plot.setScale("x", view);
    const from = strokeAt(view.min, trend, this.axis), to = strokeAt(view.max, trend, this.axis) + 1, near = aheadOf * (to - from);
    if ((from - near >= this.asked[0] || this.asked[0] === 0) && (to + near <= this.asked[1] || this.asked[1] >= trend.strokes)) return;
    this.asked = [Math.max(0, 2 * from - to), 2 * to - from];
    this.now.ahead(from, to);
  }

  private readonly wheel = (event: WheelEvent) => {
    if (!event.ctrlKey && !event.shiftKey && !event.metaKey) return;  // else the page scrolls
    event.preventDefault();
    const pixels = (event.deltaY || event.deltaX) * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : pixelsOfLine);
    const box = this.plot.over.getBoundingClientRect(), centre = this.plot.posToVal(event.clientX - box.left, "x");
    if (event.shiftKey) this.move(centre, 1, pixels / box.width); else this.move(centre, Math.exp(zoomOfPixel * pixels), 0);
  };

  private readonly key = (event: KeyboardEvent) => {
    const centre = (this.plot.scales.x.min! + this.plot.scales.x.max!) / 2;
    const moves: Record<string, () => void> = {
      ArrowLeft: () => this.move(centre, 1, -0.2), ArrowRight: () => this.move(centre, 1, 0.2),
      "+": () => this.move(centre, 0.6, 0), "-": () => this.move(centre, 1 / 0.6, 0), "0": this.all,
    };
    if (!moves[event.key]) return;
    event.preventDefault();
    moves[event.key]();
  };

  private readonly all = () => this.now.look(0, this.now.trend.strokes);

  private readonly again = () => {
    const { min, max } = this.plot.scales.x;
    this.plot.destroy();
    this.plot = this.draw();
    this.show(this.now);
    this.plot.setScale("x", { min: min!, max: max! });
  };

  private resize(): void {
    if (Math.abs(this.place.clientWidth - this.width) < 2) return;
    this.width = this.place.clientWidth;
    this.plot.setSize({ width: Math.max(240, this.width), height: this.height });
  }
}
