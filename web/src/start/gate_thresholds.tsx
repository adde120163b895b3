import type { GateBound } from "../types";
import { short } from "../units";
import { useWords } from "../words";

/** In which unit a threshold is written: as people say it. */
function shownUnit(bound: GateBound): { factor: number; name: string } {
  const rate = bound.rate ? "/s" : "";
  if (bound.si === "m") return { factor: 1000, name: `mm${rate}` };
  if (bound.si === "Pa") return { factor: 1e-5, name: `bar${rate}` };
  return { factor: 1, name: bound.si === "1" || !bound.si ? (rate ? "1/s" : "") : `${bound.si}${rate}` };
}

/** The thresholds of the gate as numbers; strokes are counted anew at every change. */
export function GateThresholds({ bounds, set }: { bounds: GateBound[]; set: (bounds: GateBound[]) => void }) {
  const say = useWords();
  const change = (index: number, side: "min" | "max", text: string) => {
    const { factor } = shownUnit(bounds[index]);
    const value = text.trim() === "" ? null : Number(text.replace(",", ".")) / factor;
    if (value !== null && !Number.isFinite(value)) return;
    set(bounds.map((bound, k) => {
      const { si: _, ...plain } = bound;
      return k === index ? { ...plain, [side]: value } : plain;
    }));
  };
  if (bounds.length === 0) return null;
  return (
    <fieldset class="gate">
      <legend>{say("gateThresholds")}</legend>
      {bounds.map((bound, index) => {
        const { factor, name } = shownUnit(bound);
        const what = bound.rate ? say("gateRate", { signal: bound.signal }) : bound.magnitude ? say("gateMagnitude", { signal: bound.signal }) : bound.signal;
        return (
          <div key={index}>
            <span>{what}</span>
            {(["min", "max"] as const).map((side) => (
              <label key={side}>{say(side === "min" ? "gateFrom" : "gateTo")} <input inputMode="decimal" aria-label={`${what} ${say(side === "min" ? "gateFrom" : "gateTo")}`}
                value={bound[side] === null ? "" : short(bound[side]! * factor, 4)} onChange={(e) => change(index, side, e.currentTarget.value)} /></label>
            ))}
            <span>{name}</span>
          </div>
        );
      })}
    </fieldset>
  );
}
