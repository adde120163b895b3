import type { Proposal } from "../types";
import { amount, grouped, printedUnit, short, shownNumber } from "../units";
import { useWords } from "../words";
import { Thumbnail } from "./thumbnail";

const longest = 1e4;  // that is read without marks between its thousands

/** "force [kN]": the unit stands in the name already. */
const holdsUnit = (name: string, unit: string) => [`[${unit}]`, `(${unit})`].some((written) => name.endsWith(written));

const plain = (value: number | null) => (value !== null && Math.abs(value) >= longest ? grouped(Math.round(value)) : short(value));

/** The columns of a log, to be dragged onto a sensor; with `insert` the name of its signal can be put where one writes. */
export function Columns({ proposal, awaited = false, insert }: { proposal: Proposal; awaited?: boolean; insert?: (signal: string) => void }) {
  const say = useWords();
  return (
    <ul class="columns" tabIndex={0} aria-label={say("mapColumns")}>
      {proposal.columns.map((column) => {
        const pin = awaited ? undefined : proposal.pins.find((known) => known.column === column.column && known.low !== undefined);
        const range = pin ? `${short(shownNumber(pin.low ?? null, pin.shown_unit ?? ""))} … ${amount(pin.high, pin.shown_unit ?? "")}` : `${plain(column.low)} … ${plain(column.high)}`;
        return (
          <li key={column.column} draggable={column.numeric} class={column.signal ? "used" : "free"}
            onDragStart={(e) => e.dataTransfer?.setData("text/plain", column.column)}>
            <span class="name">{column.name}{column.unit && !holdsUnit(column.name, column.unit) && <small> {printedUnit(column.unit)}</small>}</span>
            <Thumbnail thumbnail={column.thumbnail} />
            <span class="range">{column.numeric ? range : "–"}</span>
            <span class="role">{awaited ? "" : !column.signal ? say("mapUnused") : insert && column.signal !== "time"
              ? <button class="small code" aria-label={say("ownInsert", { signal: column.signal })} onMouseDown={(e) => e.preventDefault()} onClick={() => insert(column.signal!)}>{column.signal}</button>
              : say("mapUsedAs", { signal: column.signal })}</span>
          </li>
        );
      })}
    </ul>
  );
}
