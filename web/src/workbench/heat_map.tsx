import { useRef, useState } from "preact/hooks";
import type { ErrorMap, MapCell } from "../types";
import { amount, full, nameOf, short, shownNumber } from "../units";
import { useWords } from "../words";
import { axisName, regionText, useRangeWords, useSignalName, type Range } from "./region";

/** Edges of the cells along one signal, ascending; edges that differ by rounding alone are one. */
function edges(map: ErrorMap, axis: number): number[] {
  const all = map.cells.flatMap((cell) => [cell.from[axis], cell.to[axis]]).sort((a, b) => a - b);
  const span = all[all.length - 1] - all[0];
  return all.filter((value, k) => k === 0 || value - all[k - 1] > 1e-9 * span);
}

/** Column and row of a cell. */
type Place = [number, number];
interface Brush { from: Place; to: Place }

interface Props { map: ErrorMap; unit: string; region: Range[]; choose: (region: Range[]) => void }

/** Error over one or two signals. Cells are chosen one by one, or many by drawing over them, or by Shift with a click or Enter. */
export function HeatMap({ map, unit, region, choose }: Props) {
  const say = useWords(), rangeWords = useRangeWords(), signalName = useSignalName();
  const [brush, setBrush] = useState<Brush | null>(null);
  const last = useRef<Place>([0, 0]);
  const two = map.signals.length > 1;
  const x = edges(map, 0), y = two ? edges(map, 1) : [0, 1];
  const errors = map.cells.filter((cell) => cell.above_floor).map((cell) => cell.rms);
  const most = Math.max(...errors, 0), least = Math.min(...errors, most);
  const at = (list: number[], value: number) => list.findIndex((edge) => Math.abs(edge - value) <= 1e-9 * (list[list.length - 1] - list[0]));
  const columns = x.length - 1, rows = y.length - 1;
  const placeOf = (cell: MapCell): Place => [at(x, cell.from[0]), two ? at(y, cell.from[1]) : 0];
  const between = ({ from, to }: Brush, [column, row]: Place) =>
    column >= Math.min(from[0], to[0]) && column <= Math.max(from[0], to[0]) && row >= Math.min(from[1], to[1]) && row <= Math.max(from[1], to[1]);
  const rangesOf = ({ from, to }: Brush): Range[] => map.signals.map((signal, k) => {
    const list = k === 0 ? x : y;
    return { signal, from: list[Math.min(from[k], to[k])], to: list[Math.max(from[k], to[k]) + 1] };
  });
  const isChosen = (cell: MapCell) => region.length > 0 && region.every(({ signal, from, to }) => {
    const k = map.signals.indexOf(signal), slack = 1e-9 * (to - from);
    return k >= 0 && cell.from[k] >= from - slack && cell.to[k] <= to + slack;
  });
  const take = (next: Brush) => {
    last.current = next.from;
    const ranges = rangesOf(next);
    choose(regionText(ranges) === regionText(region) ? [] : ranges);
  };
  const tick = (list: number[], k: number, axis: number) => `${short(shownNumber(list[k], map.units[axis]))} … ${short(shownNumber(list[k + 1], map.units[axis]))}`;
  return (
    <div class="heat" style={{ "--columns": String(columns) }}>
      {two && <div class="y-name">{axisName(signalName(map.signals[1]), map.units[1])}</div>}
      <div class="cells" style={{ gridTemplateColumns: `auto repeat(${columns}, minmax(0, 1fr))`, gridTemplateRows: `repeat(${rows}, minmax(2.6rem, auto)) auto` }}
        onPointerUp={() => { if (brush) { setBrush(null); take(brush); } }} onPointerLeave={() => setBrush(null)}>
        {two && y.slice(0, -1).map((_, k) => (
          <span class="tick y" key={`y${k}`} style={{ gridColumn: 1, gridRow: rows - k }}>{tick(y, k, 1)}</span>
        ))}
        {map.cells.map((cell, k) => {
          const place = placeOf(cell), [column, row] = place;
          const shade = most > least ? 1 + Math.round((4 * (cell.rms - least)) / (most - least)) : 5;
          const words = say("locateCell", { where: map.signals.map((signal, s) => rangeWords({ signal, from: cell.from[s], to: cell.to[s] }, map.units[s])).join(", "),
            rms: cell.above_floor ? amount(cell.rms, unit) : say("locateBelow"), mean: amount(cell.mean, unit), windows: cell.windows, strokes: cell.strokes });
          return (
            <button key={k} title={words} aria-pressed={brush ? between(brush, place) : isChosen(cell)}
              class={`cell ${cell.windows === 0 ? "none" : `heat-${cell.above_floor ? shade : 0}`}`} style={{ gridColumn: column + 2, gridRow: rows - row }}
              onPointerDown={(e) => { if (e.pointerType === "mouse" && e.button === 0) { e.preventDefault(); e.currentTarget.focus(); setBrush({ from: e.shiftKey ? last.current : place, to: place }); } }}
              onPointerEnter={() => { if (brush) setBrush({ ...brush, to: place }); }}
              onClick={(e) => { if (e.detail === 0 || (e as unknown as PointerEvent).pointerType !== "mouse") take({ from: e.shiftKey ? last.current : place, to: place }); }}>
              <span class="unseen">{words}</span>
              {cell.windows > 0 && <><b aria-hidden="true">{cell.above_floor ? full(shownNumber(cell.rms, unit), 2) : ""}</b><small aria-hidden="true">{cell.windows}</small></>}
            </button>
          );
        })}
        {x.slice(0, -1).map((_, k) => <span class="tick x" key={`x${k}`} style={{ gridColumn: k + 2, gridRow: rows + 1 }}>{tick(x, k, 0)}</span>)}
      </div>
      <div class="x-name">{axisName(signalName(map.signals[0]), map.units[0])}</div>
      <p class="heat-key"><i class="heat-0" /> {say("locateBelow")}{errors.length > 0 && <span> · {short(shownNumber(least, unit))} {[1, 2, 3, 4, 5].map((k) => <i key={k} class={`heat-${k}`} />)} {short(shownNumber(most, unit))} {nameOf(unit)}</span>}</p>
    </div>
  );
}
