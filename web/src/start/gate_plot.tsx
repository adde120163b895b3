import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { Plot, pageColor, type PlotView } from "../plot";
import type { GateBound, GateCourse, LogPicture } from "../types";
import { short } from "../units";
import { useWords } from "../words";
import { LogView, timesOf } from "../log_view";
import { boundName, boundUnit, GateThresholds } from "./gate_thresholds";
import type { ProposalWork } from "./proposal";

const near = 10;  // pixels around a threshold in which it is taken hold of

interface Props { picture: LogPicture; bounds: GateBound[]; set: (bounds: GateBound[]) => void }

/** What the gate looks at over the log, strokes shaded, with its thresholds as lines to drag. */
export function GatePlots({ picture, bounds, set }: Props) {
  if (picture.gate.length !== bounds.length) return null;  // of the gate before
  return <>{picture.gate.map((course, index) => {
    const move = (side: "min" | "max", value: number) =>
      set(bounds.map((bound, k) => (k === index ? { ...bound, [side]: value } : bound)));
    return <GatePlot key={index} picture={picture} course={course} bound={bounds[index]} move={move} />;
  })}</>;
}

type Held = { side: "min" | "max"; value: number };

function GatePlot({ picture, course, bound, move }: { picture: LogPicture; course: GateCourse; bound: GateBound; move: (side: "min" | "max", value: number) => void }) {
  const say = useWords();
  const unit = boundUnit(bound);
  const view = useRef<PlotView | null>(null);
  const [held, setHeld] = useState<Held | null>(null);
  useEffect(() => setHeld(null), [bound.min, bound.max]);
  const lines = (["min", "max"] as const).filter((side) => bound[side] !== null)
    .map((side) => ({ side, value: (held?.side === side ? held.value : bound[side]!) * unit.factor }));
  const data = useMemo(() => {
    const times = timesOf(picture, say);
    return { xLabel: times.label, x: times.of(course.low, course.step), shades: times.shades,
      values: [course.low, course.high].map((list) => list.map((v) => (v === null ? null : v * unit.factor))) };
  }, [picture, course, unit.name]);
  const taken = (event: { clientY: number }) => {
    const at = view.current?.yPixel;
    return at && lines.map((line) => ({ ...line, away: Math.abs(at(line.value) - event.clientY) })).sort((a, b) => a.away - b.away).find((line) => line.away <= near);
  };
  const what = boundName(bound, say), color = pageColor("--line-a");
  const words = lines.map((line) => `${say(line.side === "min" ? "gateFrom" : "gateTo")} ${short(line.value, 4)} ${unit.name}`).join(", ");
  return (
    <div class={`gate-plot${held ? " held" : ""}`} data-bound={what}
      onPointerDownCapture={(e) => {
        const line = taken(e);
        if (!line) return;
        e.preventDefault();
        e.stopPropagation();
        e.currentTarget.setPointerCapture(e.pointerId);
        setHeld({ side: line.side, value: line.value / unit.factor });
      }}
      onTouchStart={(e) => { if (taken(e.touches[0])) e.preventDefault(); }}  // a finger drags the line, and not the page
      onMouseDownCapture={(e) => { if (held || taken(e)) e.stopPropagation(); }}
      onPointerMove={(e) => {
        if (held && view.current) setHeld({ ...held, value: view.current.yValue(e.clientY) / unit.factor });
        else e.currentTarget.style.cursor = taken(e) ? "ns-resize" : "";
      }}
      onPointerUp={() => { if (held) move(held.side, Number(held.value.toPrecision(4))); }}
      onPointerCancel={() => setHeld(null)}>
      <Plot label={`${what}: ${words}`} x={data.x} values={data.values} shades={data.shades} height={150} levels={lines.map((line) => ({ value: line.value, color: pageColor("--bad") }))} view={view}
        lines={[{ label: `${what}, ${words}`, color, width: 1 }, { label: "", color, width: 1, hidden: true }]} bands={[{ high: 1, low: 0, color }]}
        xLabel={data.xLabel} yLabel={unit.name} />
    </div>
  );
}

/** The log with what the gate lets through, and its conditions. */
export function GateOfLog({ first: { picture, proposal, setGate } }: { first: ProposalWork }) {
  const say = useWords();
  if (!picture || !proposal) return null;
  return (
    <>
      <LogView picture={picture} />
      {proposal.gate.length > 0 && <p class="quiet">{say("gateDrag")}</p>}
      <GatePlots picture={picture} bounds={proposal.gate} set={setGate} />
      <GateThresholds bounds={proposal.gate} pins={proposal.pins} set={setGate} />
    </>
  );
}
