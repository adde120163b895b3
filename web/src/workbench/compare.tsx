import { useEffect, useMemo, useState } from "preact/hooks";
import { find } from "../api";
import { Plot, pageColor } from "../plot";
import type { CompareResult, Session, StrokeError, StrokePicture } from "../types";
import { short } from "../units";
import { useWords } from "../words";
import { AsPrinted } from "./parts";
import { regionOf, stretchesIn, type Range } from "./region";

interface Props { compare?: CompareResult; session: Session; query: Record<string, string>; setUrl: (change: Record<string, string>) => void }

/** Measured beside modelled, stroke by stroke, the worst first. */
export function Compare({ compare, session, query, setUrl }: Props) {
  const say = useWords();
  const machine = session.machine!;
  const worst = useMemo(() => [...(compare?.per_stroke ?? [])].sort((a, b) => aboveNoise(b) - aboveNoise(a)), [compare]);
  const place = Math.max(0, worst.findIndex((stroke) => String(stroke.stroke) === query.stroke));
  const stroke = worst[place];
  const parent = session.versions.find((version) => version.current)?.parent ?? 0;
  const picture = usePicture(stroke?.stroke, machine.version), before = usePicture(parent ? stroke?.stroke : undefined, parent);
  const region = regionOf(query.region);
  if (!compare) return <p class="empty">{say("loading")}</p>;
  const free = query.view === "free";
  const go = (to: number) => setUrl({ stroke: String(worst[Math.min(worst.length - 1, Math.max(0, to))].stroke) });
  return (
    <>
      <h1>{say("compareTitle")}</h1>
      <p>{say("compareText", { error: `${short(compare.rms_residual)} ${compare.unit}`, noise: `${short(compare.noise_floor)} ${compare.unit}` })}</p>
      {compare.held_out && <p data-held-out={compare.held_out.rms}>{say("compareHeldOut", { log: compare.held_out.log.split("/").pop()!, error: `${short(compare.held_out.rms)} ${compare.held_out.unit}`, strokes: compare.held_out.strokes })}</p>}
      {machine.states || !stroke ? <p class="empty">{say("noStrokes")}</p> : <>
        <div class="scrubber">
          <button onClick={() => go(place - 1)} disabled={place === 0} aria-label={say("previous")}>‹</button>
          <label>
            <span>{say("compareStroke")} {stroke.stroke} · {short(stroke.rms_residual)} {compare.unit} · {say("compareOf", { n: place + 1, count: worst.length })} ({say("compareWorst")})</span>
            <input type="range" min={0} max={worst.length - 1} value={place} aria-label={say("compareStrokes")} onInput={(e) => go(Number(e.currentTarget.value))} />
          </label>
          <button onClick={() => go(place + 1)} disabled={place === worst.length - 1} aria-label={say("next")}>›</button>
        </div>
        <div class="tabs" role="group" aria-label={say("compareTitle")}>
          <button aria-pressed={!free} onClick={() => setUrl({ view: "" })}>{say("overlay")}</button>
          <button aria-pressed={free} onClick={() => setUrl({ view: "free" })}>{say("freeRun")}</button>
        </div>
        {region.length > 0 && <p class="region"><span>{say("shaded", { where: regionWords(region) })}</span> <button class="quiet small" onClick={() => setUrl({ region: "" })}>{say("locateClear")}</button></p>}
        {picture === undefined ? <p class="empty">{say("loading")}</p>
          : picture === null ? <p class="empty">{say("noStrokes")}</p>
          : free ? <FreeRun picture={picture} compare={compare} />
          : <Overlay picture={picture} before={before ?? null} parent={parent} region={region} output={machine.output} />}
      </>}
      <AsPrinted text={compare.text} />
    </>
  );
}

/** Error energy of a stroke that sensor noise does not explain. */
function aboveNoise(stroke: StrokeError): number {
  return stroke.rms_residual ** 2 - stroke.noise_floor ** 2;
}

export function regionWords(region: Range[]): string {
  return region.map(({ signal, from, to }) => `${signal} ${short(from)} … ${short(to)}`).join(", ");
}

/** The picture of a stroke: undefined while it comes, null if there is none. */
function usePicture(stroke: number | undefined, version: number): StrokePicture | null | undefined {
  const [picture, setPicture] = useState<StrokePicture | null | undefined>(undefined);
  useEffect(() => {
    if (stroke === undefined) return setPicture(null);
    let wanted = true;
    find<StrokePicture>("strokes", { stroke, version }).then((found) => wanted && setPicture(found), () => wanted && setPicture(null));
    return () => { wanted = false; };
  }, [stroke, version]);
  return picture;
}

function Overlay({ picture, before, parent, region, output }: { picture: StrokePicture; before: StrokePicture | null; parent: number; region: Range[]; output: string }) {
  const say = useWords();
  const regionKey = JSON.stringify(region);
  const data = useMemo(() => {
    const x = picture.measured.map((_, k) => k * picture.step);
    const low = picture.modelled.map((v, k) => v - 1.96 * picture.noise[k]), high = picture.modelled.map((v, k) => v + 1.96 * picture.noise[k]);
    const difference = picture.measured.map((v, k) => v - picture.modelled[k]);
    const was = before && before.measured.length === picture.measured.length ? before : null;
    const shades = stretchesIn(picture, region).map((s) => ({ ...s, color: pageColor("--region-shade") }));
    return { x, shades, flows: [low, high, picture.measured, picture.modelled, ...(was ? [was.modelled] : [])],
      differences: [picture.noise.map((n) => -1.96 * n), picture.noise.map((n) => 1.96 * n), difference, ...(was ? [was.measured.map((v, k) => v - was.modelled[k])] : [])], was: was !== null };
  }, [picture, before, regionKey]);
  const band = pageColor("--band"), a = pageColor("--line-a"), b = pageColor("--line-b"), ink = pageColor("--line-measured");
  const hidden = { color: "transparent", hidden: true };
  const old = data.was ? [{ label: say("before", { version: parent }), color: b, dashed: true }] : [];
  return (
    <>
      <Plot label={`${say("compareTitle")}: ${say("compareStroke")} ${picture.stroke}`} x={data.x} values={data.flows} shades={data.shades} height={270}
        bands={[{ high: 1, low: 0, color: band }]} xLabel={`${say("time")} (s)`} yLabel={`${output} (${picture.unit})`}
        lines={[{ label: say("noiseBand"), color: band }, { label: "high", ...hidden }, { label: say("measured"), color: ink, width: 1.2 }, { label: say("modelled"), color: a, width: 2 }, ...old]} />
      <Plot label={`${say("difference")}: ${say("compareStroke")} ${picture.stroke}`} x={data.x} values={data.differences} shades={data.shades} height={150}
        bands={[{ high: 1, low: 0, color: band }]} xLabel={`${say("time")} (s)`} yLabel={picture.unit}
        lines={[{ label: say("noiseBand"), color: band }, { label: "high", ...hidden }, { label: say("difference"), color: a }, ...old]} />
    </>
  );
}

function FreeRun({ picture, compare }: { picture: StrokePicture; compare: CompareResult }) {
  const say = useWords();
  const run = picture.free_run;
  const data = useMemo(() => run && { x: run.measured.map((_, k) => k * run.step), values: [run.measured, run.simulated] }, [run]);
  if (!run || !data) return <p class="empty">{say("freeRunNone")}</p>;
  return (
    <>
      <p>{say("freeRunText")} {compare.free_run_bar !== null && `${short(compare.free_run_bar)} bar rms`}</p>
      <Plot label={`${say("freeRun")}: ${say("compareStroke")} ${picture.stroke}`} x={data.x} values={data.values} height={300} xLabel={`${say("time")} (s)`} yLabel={run.unit}
        lines={[{ label: say("measured"), color: pageColor("--line-measured"), width: 1.2 }, { label: say("modelled"), color: pageColor("--line-a"), width: 2 }]} />
    </>
  );
}
