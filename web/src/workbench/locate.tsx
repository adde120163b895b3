import type { CompareResult, ErrorMap, MapCell } from "../types";
import { short } from "../units";
import { useWords } from "../words";
import { regionWords } from "./compare";
import { regionOf, regionText, type Range } from "./region";

interface Props { compare?: CompareResult; query: Record<string, string>; setUrl: (change: Record<string, string>) => void }

const nameOf = (map: ErrorMap) => map.signals.join(" × ");

/** Heat map of the error over the operating space. */
export function Locate({ compare, query, setUrl }: Props) {
  const say = useWords();
  if (!compare) return <p class="empty">{say("loading")}</p>;
  const maps = [...compare.maps].sort((a, b) => b.signals.length - a.signals.length || b.explained - a.explained);
  const map = maps.find((m) => nameOf(m) === query.map) ?? maps[0];
  const region = regionOf(query.region);
  if (!map) return <><h1>{say("locateTitle")}</h1><p class="empty">{say("locateNothing")}</p></>;
  const choose = (cell: MapCell) => setUrl({ region: regionText(rangesOf(map, cell)) });
  const flat = map.cells.every((cell) => !cell.above_floor);
  return (
    <>
      <h1>{say("locateTitle")}</h1>
      <p>{flat ? say("locateNothing") : say("locateText")}</p>
      <label>{say("locateOver")} <select value={nameOf(map)} onChange={(e) => setUrl({ map: e.currentTarget.value, region: "" })}>
        {maps.map((m) => <option key={nameOf(m)} value={nameOf(m)}>{nameOf(m)} ({Math.max(0, Math.round(100 * m.explained))} %)</option>)}
      </select></label>
      <p class="quiet">{say("locateExplains", { share: Math.max(0, Math.round(100 * map.explained)) })}</p>
      <HeatMap map={map} unit={compare.unit} region={region} choose={choose} />
      {region.length > 0 && <p class="region">
        <button class="primary" onClick={() => setUrl({ step: "compare" })}>{say("locateShow")}</button>{" "}
        <span>{regionWords(region)}</span>{" "}
        <button class="quiet small" onClick={() => setUrl({ region: "" })}>{say("locateClear")}</button></p>}
      {compare.located.length > 0 && <>
        <h2>{say("locateMost")}</h2>
        <ul class="located">
          {compare.located.slice(0, 5).map((l, k) => (
            <li key={k}><button class="quiet" onClick={() => setUrl({ region: regionText([l]) })}>
              <strong>{l.signal} {short(l.from)} … {short(l.to)} {l.unit}</strong></button>{" "}
              {short(l.rms)} {compare.unit} rms · {say("locateShare", { error: Math.round(100 * l.share_error), time: Math.round(100 * l.share_windows) })}</li>
          ))}
        </ul>
      </>}
    </>
  );
}

function rangesOf(map: ErrorMap, cell: MapCell): Range[] {
  return map.signals.map((signal, k) => ({ signal, from: cell.from[k], to: cell.to[k] }));
}

/** Edges of the cells along one signal, ascending; edges that differ by rounding alone are one. */
function edges(map: ErrorMap, axis: number): number[] {
  const all = map.cells.flatMap((cell) => [cell.from[axis], cell.to[axis]]).sort((a, b) => a - b);
  const span = all[all.length - 1] - all[0];
  return all.filter((value, k) => k === 0 || value - all[k - 1] > 1e-9 * span);
}

function HeatMap({ map, unit, region, choose }: { map: ErrorMap; unit: string; region: Range[]; choose: (cell: MapCell) => void }) {
  const say = useWords();
  const x = edges(map, 0), y = map.signals.length > 1 ? edges(map, 1) : [0, 1];
  const errors = map.cells.filter((cell) => cell.above_floor).map((cell) => cell.rms);
  const most = Math.max(...errors, 0), least = Math.min(...errors, most);
  const at = (list: number[], value: number) => list.findIndex((edge) => Math.abs(edge - value) <= 1e-9 * (list[list.length - 1] - list[0]));
  const axisName = (k: number) => `${map.signals[k]}${map.units[k] ? ` (${map.units[k]})` : ""}`;
  const columns = x.length - 1, rows = y.length - 1;
  const chosen = regionText(region);
  return (
    <div class="heat" style={{ "--columns": String(columns) }}>
      {map.signals.length > 1 && <div class="y-name">{axisName(1)}</div>}
      <div class="cells" style={{ gridTemplateColumns: `auto repeat(${columns}, minmax(0, 1fr))`, gridTemplateRows: `repeat(${rows}, minmax(2.6rem, auto)) auto` }}>
        {map.signals.length > 1 && y.slice(0, -1).map((from, k) => (
          <span class="tick y" key={`y${k}`} style={{ gridColumn: 1, gridRow: rows - k }}>{short(from)} … {short(y[k + 1])}</span>
        ))}
        {map.cells.map((cell, k) => {
          const column = at(x, cell.from[0]), row = map.signals.length > 1 ? at(y, cell.from[1]) : 0;
          const shade = most > least ? 1 + Math.round((4 * (cell.rms - least)) / (most - least)) : 5;
          const words = say("locateCell", { where: regionWords(rangesOf(map, cell)), rms: cell.above_floor ? `${short(cell.rms)} ${unit}` : say("locateBelow"),
            mean: `${short(cell.mean)} ${unit}`, windows: cell.windows, strokes: cell.strokes });
          return (
            <button key={k} title={words} aria-pressed={chosen === regionText(rangesOf(map, cell))} onClick={() => choose(cell)}
              class={`cell heat-${cell.above_floor ? shade : 0}`}
              style={{ gridColumn: column + 2, gridRow: rows - row }}>
              <span class="unseen">{words}</span>
              {cell.windows > 0 && <><b aria-hidden="true">{cell.above_floor ? short(cell.rms, 2) : ""}</b><small aria-hidden="true">{cell.windows}</small></>}
            </button>
          );
        })}
        {x.slice(0, -1).map((from, k) => <span class="tick x" key={`x${k}`} style={{ gridColumn: k + 2, gridRow: rows + 1 }}>{short(from)} … {short(x[k + 1])}</span>)}
      </div>
      <div class="x-name">{axisName(0)}</div>
      <p class="heat-key"><i class="heat-0" /> {say("locateBelow")}{errors.length > 0 && <span> · {short(least)} {[1, 2, 3, 4, 5].map((k) => <i key={k} class={`heat-${k}`} />)} {short(most)} {unit}</span>}</p>
    </div>
  );
}
