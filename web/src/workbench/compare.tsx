import { useMemo } from "preact/hooks";
import { Plot, pageColor } from "../plot";
import type { CompareResult, RegionErrors, Session, StrokePicture } from "../types";
import { Told, useTold } from "../told";
import { amount, nameOf, shareOfVariation, shownUnit, unitsKey } from "../units";
import { useWords } from "../words";
import { AsPrinted } from "./parts";
import { regionOf, useRegionWords } from "./region";
import { Outputs, usePicture } from "./stroke_overlay";

interface Props { compare?: CompareResult; errors: RegionErrors | null; session: Session; query: Record<string, string>; setUrl: (change: Record<string, string>) => void }

/** `windows`: of a region, how many of the stroke lie there. */
interface Listed { stroke: number; rms: number; noise: number; windows?: number }

/** Measured beside modelled, stroke by stroke, the worst first; of a region that was chosen, only strokes and windows there. */
export function Compare({ compare, errors, session, query, setUrl }: Props) {
  const say = useWords(), tell = useTold(), regionWords = useRegionWords();
  const machine = session.machine!;
  const region = regionOf(query.region);
  const worst = useMemo(() => {
    const strokes: Listed[] = region.length > 0 && errors ? errors.strokes
      : (compare?.per_stroke ?? []).map((s) => ({ stroke: s.stroke, rms: s.rms_residual, noise: s.noise_floor ?? 0 }));
    return [...strokes].sort((a, b) => aboveNoise(b) - aboveNoise(a));
  }, [compare, errors, query.region]);
  const place = Math.max(0, worst.findIndex((stroke) => String(stroke.stroke) === query.stroke));
  const stroke = worst[place];
  const parent = session.versions.find((version) => version.current)?.parent ?? 0;
  const picture = usePicture(stroke?.stroke, machine.version, compare), before = usePicture(parent ? stroke?.stroke : undefined, parent, compare);
  if (!compare) return <p class="empty">{say("loading")}</p>;
  const odd = compare.odd_strokes ?? [];
  const free = query.drawn === "free" && !machine.states;
  const log = session.logs.length > 1 ? compare.per_stroke.find((s) => s.stroke === stroke?.stroke)?.log : undefined;
  const go = (to: number) => setUrl({ stroke: String(worst[Math.min(worst.length - 1, Math.max(0, to))].stroke) });
  return (
    <>
      <h1>{say("compareTitle")}</h1>
      <p>{say(machine.states ? "compareStates" : odd.length > 0 ? "compareSome" : "compareText", { described: compare.strokes_described ?? compare.strokes, count: compare.strokes, error: amount(compare.rms_residual, compare.unit), noise: amount(compare.noise_floor, compare.unit) })}{compare.unit === shareOfVariation && ` ${say("ofVariation")}`}</p>
      {odd.map((some) => <p key={some.strokes.join()}>{say("notEverywhere")}<Told of={some} what="sentence" /></p>)}
      {compare.held_out && <p data-held-out={compare.held_out.rms}>{say("compareHeldOut", { log: compare.held_out.log.split("/").pop()!, error: amount(compare.held_out.rms, compare.held_out.unit), strokes: compare.held_out.strokes })}</p>}
      {region.length > 0 && <p class="region"><span>{say("onlyThere", { where: regionWords(region, compare.maps) })}{errors && ` ${say("errorThere", { error: amount(errors.rms, errors.unit), noise: amount(errors.noise, errors.unit), windows: errors.windows, strokes: errors.strokes.length })}`}</span> <button class="quiet small" onClick={() => setUrl({ region: "" })}>{say("locateClear")}</button></p>}
      {!stroke ? <p class="empty">{say("noStrokes")}</p> : <>
        <div class="scrubber">
          <button onClick={() => go(place - 1)} disabled={place === 0} aria-label={say("previous")}>‹</button>
          <label>
            <span>{say("compareStroke")} {stroke.stroke}{log && ` · ${log}`} · {amount(stroke.rms, compare.unit)} · {say("compareOf", { n: place + 1, count: worst.length })} ({say("compareWorst")})</span>
            <input type="range" min={0} max={worst.length - 1} value={place} aria-label={say("compareStrokes")} onInput={(e) => go(Number(e.currentTarget.value))} />
          </label>
          <button onClick={() => go(place + 1)} disabled={place === worst.length - 1} aria-label={say("next")}>›</button>
        </div>
        {!machine.states && <div class="tabs" role="group" aria-label={say("compareTitle")}>
          <button aria-pressed={!free} onClick={() => setUrl({ drawn: "" })}>{say("overlay")}</button>
          <button aria-pressed={free} onClick={() => setUrl({ drawn: "free" })}>{say("freeRun")}</button>
          {machine.valve && <button onClick={() => setUrl({ drawn: "valve" })}>{say("valveTab")}</button>}
        </div>}
        {picture === undefined ? <p class="empty">{say("loading")}</p>
          : picture === null ? <p class="empty">{say("noStrokes")}</p>
          : free ? <FreeRun picture={picture} compare={compare} />
          : <Outputs picture={picture} before={before ?? null} parent={parent} region={region} output={tell(machine, "output").text} chosen={query.output} choose={(output) => setUrl({ output })} />}
      </>}
      <AsPrinted text={compare.text} />
    </>
  );
}

/** Error energy of a stroke that sensor noise does not explain; of a region in all of its windows there, since one of them says little. */
function aboveNoise(stroke: Listed): number {
  return (stroke.windows ?? 1) * (stroke.rms ** 2 - stroke.noise ** 2);
}

function FreeRun({ picture, compare }: { picture: StrokePicture; compare: CompareResult }) {
  const say = useWords();
  const run = picture.free_run;
  const data = useMemo(() => {
    if (!run) return null;
    const { factor, offset } = shownUnit(run.unit), of = (list: number[]) => list.map((v) => v * factor + offset);
    return { x: run.measured.map((_, k) => k * run.step), values: [of(run.measured), of(run.simulated)] };
  }, [run, unitsKey()]);
  if (!run || !data) return <p class="empty">{say("freeRunNone")}</p>;
  return (
    <>
      <p>{say("freeRunText")} {compare.free_run_bar !== null && `${amount(compare.free_run_bar, "bar")} rms`}</p>
      <Plot label={`${say("freeRun")}: ${say("compareStroke")} ${picture.stroke}`} x={data.x} values={data.values} height={300} xLabel={`${say("time")} (s)`} yLabel={`${run.signal} (${nameOf(run.unit)})`}
        lines={[{ label: say("measured"), color: pageColor("--line-measured"), width: 1.2 }, { label: say("modelled"), color: pageColor("--line-a"), width: 2 }]} />
    </>
  );
}
