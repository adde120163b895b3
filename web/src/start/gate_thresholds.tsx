import { useState } from "preact/hooks";
import type { GateBound, Pin } from "../types";
import { inChosen, short, unitName, type Units } from "../units";
import { useWords, type Say } from "../words";

/** SI units as people say them, before there is a machine file. */
export const saidUnits: Units = { m: { factor: 1000, offset: 0, name: "mm" }, Pa: { factor: 1e-5, offset: 0, name: "bar" } };

/** In which unit a threshold is written: as people say it. */
export function boundUnit(bound: GateBound): { factor: number; name: string } {
  const rate = bound.rate ? "/s" : "", said = saidUnits[bound.si ?? ""];
  if (said) return inChosen({ ...said, name: said.name + rate });
  return { factor: 1, name: bound.si === "1" || !bound.si ? (rate ? "1/s" : "") : `${bound.si}${rate}` };
}

const lengths = ["m", "rad"];  // whose rate is a speed

/** "speed of z" */
export function boundName({ signal, si, rate, magnitude }: GateBound, say: Say): string {
  const what = !rate ? signal : say(lengths.includes(si ?? "") ? "gateRate" : "gateChange", { signal });
  return magnitude ? say("gateMagnitude", { signal: what }) : what;
}

const sides = ["min", "max"] as const;
type Side = (typeof sides)[number];
const numberOf = (text: string) => Number(text.replace(",", "."));

function Limit({ bound, side, name, take }: { bound: GateBound; side: Side; name: string; take: (value: number | null) => void }) {
  const say = useWords();
  const { factor } = boundUnit(bound), word = say(side === "min" ? "gateFrom" : "gateTo");
  const change = (text: string) => {
    if (text.trim() === "") return take(null);
    if (Number.isFinite(numberOf(text))) take(numberOf(text) / factor);
  };
  return (
    <label>{word} <input inputMode="decimal" aria-label={`${name} ${word}`} value={bound[side] === null ? "" : short(bound[side]! * factor, 4)}
      onChange={(e) => change(e.currentTarget.value)} /></label>
  );
}

interface Props { bounds: GateBound[]; pins: Pin[]; set: (bounds: GateBound[]) => void }

/** The conditions of the gate with their thresholds as numbers; strokes are counted anew at every change. */
export function GateThresholds({ bounds, pins, set }: Props) {
  const say = useWords();
  const take = (index: number, side: Side, value: number | null) => {
    const changed = { ...bounds[index], [side]: value };
    set(changed.min === null && changed.max === null ? bounds.filter((_, k) => k !== index) : bounds.map((bound, k) => (k === index ? changed : bound)));
  };
  return (
    <fieldset class="gate">
      <legend>{say("gateThresholds")}</legend>
      {bounds.map((bound, index) => {
        const name = boundName(bound, say);
        return (
          <div key={`${index} ${name}`} class="condition">
            <span>{name}</span>
            {sides.map((side) => <Limit key={side} bound={bound} side={side} name={name} take={(value) => take(index, side, value)} />)}
            <span>{unitName(boundUnit(bound))}</span>
            <button class="small" aria-label={`${say("balanceDrop")}: ${name}`} onClick={() => set(bounds.filter((_, k) => k !== index))}>×</button>
          </div>
        );
      })}
      <NewCondition pins={pins} add={(bound) => set([...bounds, bound])} />
    </fieldset>
  );
}

const looks = { gateValue: [false, false], gateSpeed: [true, false], gateSize: [false, true], gateSpeedSize: [true, true] } as const;  // rate, magnitude

/** One more condition: it counts as soon as one of its thresholds is written. */
function NewCondition({ pins, add }: { pins: Pin[]; add: (bound: GateBound) => void }) {
  const say = useWords();
  const measured = pins.filter((pin) => pin.column && pin.signal !== "time");
  const [signal, setSignal] = useState("");
  const [look, setLook] = useState<keyof typeof looks>("gateValue");
  const pin = measured.find((known) => known.signal === signal);
  const [rate, magnitude] = looks[look];
  const bound: GateBound = { signal, rate, magnitude, si: pin?.si, min: null, max: null };
  const take = (side: Side, value: number | null) => {
    if (value === null) return;
    add({ ...bound, [side]: value });
    setSignal("");
  };
  return (
    <div class="condition new">
      <select name="gate-signal" aria-label={say("gateMore")} value={pin ? signal : ""} onChange={(e) => setSignal(e.currentTarget.value)}>
        <option value="">{say("gateMore")}</option>
        {measured.map((known) => <option key={known.signal} value={known.signal}>{known.signal}</option>)}
      </select>
      {pin && <>
        <select name="gate-look" aria-label={say("gateLook")} value={look} onChange={(e) => setLook(e.currentTarget.value as keyof typeof looks)}>
          {(Object.keys(looks) as (keyof typeof looks)[]).map((known) => <option key={known} value={known}>{say(known)}</option>)}
        </select>
        {sides.map((side) => <Limit key={`${side} ${signal} ${look}`} bound={bound} side={side} name={boundName(bound, say)} take={(value) => take(side, value)} />)}
        <span>{unitName(boundUnit(bound))}</span>
      </>}
    </div>
  );
}
