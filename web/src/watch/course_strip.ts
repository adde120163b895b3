// The courses of a trend as tiles of a long picture. While one pans, they are copied, and drawn only where the view comes to: a frame
// then costs the same whatever the courses look like, where filling their ragged bands anew takes longer than a frame without a
// graphics card.

import type uPlot from "uplot";
import type { Courses } from "./trend_courses";
import type { MaybeNumber } from "./watch_types";

export interface CourseColors { range: string; band: string; mean: string; healthy: string }

/** How places become pixels: a pixel's width on the axis, heights of the edges, and the place that pixels are counted from. */
interface Scale { origin: number; step: number; low: number; high: number; height: number }
/** A tile: the place of its first pixel, and how many there are. */
interface Frame extends Scale { first: number; width: number }

const dashPeriod = (dash: number[]) => devicePixelRatio * dash.reduce((sum, length) => sum + length, 0) || 1;

const tileWidth = 256;  // pixels of the screen
const mostTiles = 64;   // kept: several widths of a view
const sameStep = 1e-6;  // relative: places of dates have no more digits

/** Lowest and highest place (pixels from the top) of a band in every column of pixels, on the line that joins bins where they stand apart. */
function columnsOf(x: number[], low: MaybeNumber[], high: MaybeNumber[], frame: Frame) {
  const top = new Float32Array(frame.width).fill(Infinity), bottom = new Float32Array(frame.width).fill(-Infinity);
  const row = (value: number) => ((frame.high - value) / (frame.high - frame.low)) * frame.height;
  const mark = (column: number, upper: number, lower: number) => {
    if (column < 0 || column >= frame.width) return;
    top[column] = Math.min(top[column], upper);
    bottom[column] = Math.max(bottom[column], lower);
  };
  let before: { column: number; upper: number; lower: number } | null = null;
  for (let k = 0; k < x.length; ++k) {
    const a = low[k], b = high[k];
    if (a === null || b === null) { before = null; continue; }
    const here = { column: Math.round((x[k] - frame.first) / frame.step), upper: row(b), lower: row(a) };
    mark(here.column, here.upper, here.lower);
    const gap: number = before ? here.column - before.column : 0;
    for (let column = before ? Math.max(before.column + 1, 0) : 0; before && column < Math.min(here.column, frame.width); ++column) {
      const share = (column - before.column) / gap;
      mark(column, before.upper + share * (here.upper - before.upper), before.lower + share * (here.lower - before.lower));
    }
    before = here;
  }
  return { top, bottom };
}

function fillBand(ctx: CanvasRenderingContext2D, { x, low, high }: { x: number[]; low: MaybeNumber[]; high: MaybeNumber[] }, color: string, frame: Frame) {
  const { top, bottom } = columnsOf(x, low, high, frame);
  ctx.fillStyle = color;
  for (let column = 0; column < frame.width; ++column) {
    if (!(bottom[column] >= top[column])) continue;
    ctx.fillRect(column, top[column], 1, Math.max(1, bottom[column] - top[column]));
  }
}

function strokeLine(ctx: CanvasRenderingContext2D, x: number[], y: MaybeNumber[], look: { color: string; width: number; dash: number[] }, frame: Frame) {
  ctx.strokeStyle = look.color;
  ctx.lineWidth = look.width * devicePixelRatio;
  ctx.setLineDash(look.dash.map((length) => length * devicePixelRatio));
  ctx.lineDashOffset = x.length > 0 ? ((x[0] - frame.origin) / frame.step) % dashPeriod(look.dash) : 0;  // dashes go on from tile to tile
  ctx.beginPath();
  let joins = false;
  for (let k = 0; k < x.length; ++k) {
    const value = y[k];
    if (value === null) { joins = false; continue; }
    const right = (x[k] - frame.first) / frame.step, down = ((frame.high - value) / (frame.high - frame.low)) * frame.height;
    if (joins) ctx.lineTo(right, down); else ctx.moveTo(right, down);
    joins = true;
  }
  ctx.stroke();
}

/** First point of the axis that is not before a place. */
function pointAt(x: number[], place: number): number {
  let low = 0, high = x.length;
  while (low < high) {
    const half = (low + high) >> 1;
    if (x[half] < place) low = half + 1; else high = half;
  }
  return low;
}

/** Of one set of courses, for one plot at a time. */
export class CourseStrip {
  private readonly tiles = new Map<number, HTMLCanvasElement>();
  private scale: Scale | null = null;

  constructor(private readonly courses: Courses, private readonly colors: CourseColors) {}

  /** Copies what the scales of the plot show onto it; only tiles that are not there yet are drawn. */
  copyTo(plot: uPlot): void {
    const { left, top, width, height } = plot.bbox, { min, max } = plot.scales.x, heights = plot.scales.y;
    if (min == null || max == null || heights.min == null || heights.max == null || width < 1 || height < 1) return;
    const step = (max - min) / width, before = this.scale;
    const same = before !== null && before.height === height && before.low === heights.min && before.high === heights.max && Math.abs(before.step / step - 1) < sameStep;
    if (!same || this.tiles.size > mostTiles) this.tiles.clear();
    const scale = same ? before : (this.scale = { origin: min, step, low: heights.min, high: heights.max, height });
    const from = Math.round((min - scale.origin) / scale.step);
    plot.ctx.save();
    plot.ctx.beginPath();
    plot.ctx.rect(left, top, width, height);
    plot.ctx.clip();
    for (let tile = Math.floor(from / tileWidth); tile * tileWidth < from + width; ++tile)
      plot.ctx.drawImage(this.tileOf(tile, scale), left + tile * tileWidth - from, top);
    plot.ctx.restore();
  }

  private tileOf(tile: number, scale: Scale): HTMLCanvasElement {
    const there = this.tiles.get(tile);
    if (there) return there;
    const canvas = document.createElement("canvas"), { x } = this.courses;
    canvas.width = tileWidth;
    canvas.height = scale.height;
    const frame = { ...scale, first: scale.origin + tile * tileWidth * scale.step, width: tileWidth };
    const first = Math.max(0, pointAt(x, frame.first) - 1), end = pointAt(x, frame.first + (tileWidth + 1) * scale.step) + 1;
    const part = (list: MaybeNumber[]) => list.slice(first, end), places = x.slice(first, end);
    const ctx = canvas.getContext("2d")!;
    fillBand(ctx, { x: places, low: part(this.courses.low), high: part(this.courses.high) }, this.colors.range, frame);
    fillBand(ctx, { x: places, low: part(this.courses.below), high: part(this.courses.above) }, this.colors.band, frame);
    strokeLine(ctx, places, part(this.courses.mean), { color: this.colors.mean, width: 1.8, dash: [] }, frame);
    strokeLine(ctx, places, part(this.courses.healthy), { color: this.colors.healthy, width: 1.6, dash: [6, 4] }, frame);
    this.tiles.set(tile, canvas);
    return canvas;
  }
}
