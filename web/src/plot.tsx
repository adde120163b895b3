// uPlot in a box: as wide as it, in the colours of the page, drawn anew when these change.

import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { short } from "./units";

export interface Line { label: string; color: string; dashed?: boolean; width?: number; hidden?: boolean; sparse?: boolean; dots?: boolean }  // sparse: drawn over points without a value; dots: in place of a line
/** A height across the whole picture. */
export interface Level { value: number; color: string }
/** Between heights of the picture and places in the window, pixels. */
export interface PlotView { yPixel: (value: number) => number; yValue: (pixel: number) => number }
export interface Shade { from: number; to: number; color: string }

interface Props {
  label: string;  // what the picture shows, for those who cannot see it
  x: number[];
  lines: Line[];
  values: (number | null)[][];
  bands?: { high: number; low: number; color: string }[];  // between lines, numbered from 0
  bars?: { high: number; low: number; color: string };  // upright between two lines at every place, of points with intervals
  xLabel: string;
  yLabel: string;
  height: number;
  shades?: Shade[];  // stretches of x
  levels?: Level[];  // across, which the picture has room for
  view?: { current: PlotView | null };
  logX?: boolean;
  yRange?: [number, number];
}

/** A colour of the page, by its name in style.css. */
export function pageColor(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

const low = 200;  // height of a picture below which its ticks stand closer

/** What axes look like on this page. */
export function axisLook(): Partial<uPlot.Axis> {
  const line = { stroke: pageColor("--grid"), width: 1 };
  return { stroke: pageColor("--text"), grid: line, ticks: line, font: "12px system-ui", labelFont: "12px system-ui" };
}

const axis = (label: string, size: number): uPlot.Axis =>
  ({ ...axisLook(), label, size, labelSize: 20, values: (_, splits) => splits.map((value) => short(value, 4)) });

/** Keeps a picture in its place: as wide as that, and drawn anew in other colours. Gives back how to take it away. */
export function keepDrawn(place: HTMLElement, draw: (width: number) => uPlot): () => void {
  const least = 200;  // pixels
  let width = place.clientWidth, plot = draw(Math.max(least, width));
  const again = () => { plot.destroy(); plot = draw(Math.max(least, width)); };
  const resized = new ResizeObserver(() => {
    if (Math.abs(place.clientWidth - width) < 2) return;
    width = place.clientWidth;
    plot.setSize({ width: Math.max(least, width), height: plot.height });
  });
  resized.observe(place);
  addEventListener("themechange", again);
  return () => { resized.disconnect(); removeEventListener("themechange", again); plot.destroy(); };
}

/** Of a scale of logarithms: 1, 2, 5, 10, 20 ... */
export const isRound = (value: number | null) => value !== null && /^[125]e/.test(Number(value.toPrecision(3)).toExponential());

function drawShades(plot: uPlot, shades: Shade[]) {
  plot.ctx.save();
  for (const shade of shades) {
    const left = plot.valToPos(shade.from, "x", true), right = plot.valToPos(shade.to, "x", true);
    plot.ctx.fillStyle = shade.color;
    plot.ctx.fillRect(left, plot.bbox.top, Math.max(1, right - left), plot.bbox.height);
  }
  plot.ctx.restore();
}

function drawLevels(plot: uPlot, levels: Level[]) {
  plot.ctx.save();
  plot.ctx.lineWidth = 2 * devicePixelRatio;
  for (const level of levels) {
    const y = plot.valToPos(level.value, "y", true);
    plot.ctx.strokeStyle = level.color;
    plot.ctx.beginPath();
    plot.ctx.moveTo(plot.bbox.left, y);
    plot.ctx.lineTo(plot.bbox.left + plot.bbox.width, y);
    plot.ctx.stroke();
  }
  plot.ctx.restore();
}

/** With some room beside the first and the last of a scale of logarithms. */
const beside = (_: uPlot, low: number, high: number): [number, number] => [low / 1.08, high * 1.08];

/** The heights of what is drawn, with room for the levels. */
function withRoom(low: number | null, high: number | null, levels: Level[]): [number, number] {
  const all = [low ?? 0, high ?? 1, ...levels.map((level) => level.value)], a = Math.min(...all), b = Math.max(...all);
  return [a - 0.08 * (b - a || 1), b + 0.08 * (b - a || 1)];
}

function drawBars(plot: uPlot, bars: { high: number; low: number; color: string }) {
  plot.ctx.save();
  plot.ctx.strokeStyle = bars.color;
  plot.ctx.lineWidth = 1.2 * devicePixelRatio;
  plot.ctx.beginPath();
  plot.data[0].forEach((at, k) => {
    const low = plot.data[bars.low + 1][k], high = plot.data[bars.high + 1][k];
    if (low === null || low === undefined || high === null || high === undefined) return;
    const x = plot.valToPos(at, "x", true);
    plot.ctx.moveTo(x, plot.valToPos(low, "y", true));
    plot.ctx.lineTo(x, plot.valToPos(high, "y", true));
  });
  plot.ctx.stroke();
  plot.ctx.restore();
}

export function Plot({ label, x, lines, values, bands, bars, xLabel, yLabel, height, shades, levels, view, logX, yRange }: Props) {
  const shown = useRef<uPlot | null>(null), across = useRef<Level[]>([]);
  across.current = levels ?? [];
  useEffect(() => shown.current?.redraw(false), [JSON.stringify(levels)]);
  const box = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => {  // with the page around it
    const place = box.current;
    if (!place) return;
    return keepDrawn(place, (width) => {
      const plot = new uPlot({
        width, height,
        scales: { x: { time: false, ...(logX ? { distr: 3 as const, range: beside } : {}) }, ...(yRange ? { y: { range: yRange } } : levels ? { y: { range: (_: uPlot, low: number | null, high: number | null) => withRoom(low, high, across.current) } } : {}) },
        pxAlign: 0,
        axes: [{ ...axis(xLabel, 34), ...(logX ? { filter: (_: uPlot, splits: number[]) => splits, values: (_: uPlot, splits: number[]) => splits.map((value) => (isRound(value) ? short(value, 2) : "")) } : {}) }, { ...axis(yLabel, 60), space: height < low ? 18 : 30 }],
        series: [{ label: xLabel }, ...lines.map((line) => ({
          label: line.label, stroke: line.color, width: line.width ?? 1.6, dash: line.dashed ? [6, 4] : undefined, spanGaps: line.sparse,
          ...(line.dots ? { paths: () => null, points: { show: true, size: 5, fill: line.color } } : { points: { show: false } }),
        }))],
        bands: bands?.map((band) => ({ series: [band.high + 1, band.low + 1] as [number, number], fill: band.color })),
        legend: { show: false },
        hooks: { drawClear: [(u) => drawShades(u, shades ?? [])], draw: [(u) => drawLevels(u, across.current), ...(bars ? [(u: uPlot) => drawBars(u, bars)] : [])] },
        cursor: { drag: { x: true, y: false } },
      }, [x, ...values] as uPlot.AlignedData, place);
      shown.current = plot;
      const top = () => plot.over.getBoundingClientRect().top;
      if (view) view.current = { yPixel: (value) => plot.valToPos(value, "y") + top(), yValue: (pixel) => plot.posToVal(pixel - top(), "y") };
      return plot;
    });
  }, [x, values, shades, xLabel, yLabel, height, JSON.stringify(lines)]);
  return (
    <figure class="plot">
      <div ref={box} role="img" aria-label={label} />
      <figcaption>
        {lines.map((line, k) => !line.hidden && (
          <span class="key" key={line.label}><Swatch {...line} band={bands?.some(({ low }) => low === k) && !line.width} />{line.label}</span>
        ))}
      </figcaption>
    </figure>
  );
}

function Swatch({ color, dashed, dots, band }: Pick<Line, "color" | "dashed" | "dots"> & { band?: boolean }) {
  return (
    <svg width="24" height="8" aria-hidden="true">
      {band ? <rect width="24" height="8" fill={color} /> : dots ? <circle cx="12" cy="4" r="3" fill={color} /> : <line x1="0" y1="4" x2="24" y2="4" stroke={color} stroke-width="3" stroke-dasharray={dashed ? "6 4" : undefined} />}
    </svg>
  );
}
