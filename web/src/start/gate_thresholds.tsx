import type { GateBound } from "../types";
import { inChosen, short } from "../units";
import { useWords, type Say } from "../words";

/** In which unit a threshold is written: as people say it. */
export function boundUnit(bound: GateBound): { factor: number; name: string } {
  const rate = bound.rate ? "/s" : "";
  if (bound.si === "m") return inChosen({ factor: 1000, offset: 0, name: `mm${rate}` });
  if (bound.si === "Pa") return inChosen({ factor: 1e-5, offset: 0, name: `bar${rate}` });
  return { factor: 1, name: bound.si === "1" || !bound.si ? (rate ? "1/s" : "") : `${bound.si}${rate}` };
}

/** "speed of z" */
export function boundName(bound: GateBound, say: Say): string {
  return bound.rate ? say("gateRate", { signal: bound.signal }) : bound.magnitude ? say("gateMagnitude", { signal: bound.signal }) : bound.signal;
}

/** The thresholds of the gate as numbers; strokes are counted anew at every change. */
export function GateThresholds({ bounds, set }: { bounds: GateBound[]; set: (bounds: GateBound[]) => void }) {
  const say = useWords();
  const change = (index: number, side: "min" | "max", text: string) => {
    const { factor } = boundUnit(bounds[index]);
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
        const { factor, name } = boundUnit(bound), what = boundName(bound, say);
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
