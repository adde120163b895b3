import { useLayoutEffect, useMemo, useState } from "preact/hooks";
import { find } from "../api";
import { Plot, pageColor } from "../plot";
import type { CompareResult, StrokeError, StrokePicture } from "../types";
import { nameOf, shownUnit, unitsKey } from "../units";
import { useWords } from "../words";
import { insideOf, stretchesIn, type Range } from "./region";

/** The stroke that tells most of a model: the one with the largest energy of its error, so no short one by its noise. */
export function tellingStroke(compare: CompareResult): number | undefined {
  const energy = (stroke: StrokeError) => (stroke.windows ?? stroke.rows ?? 1) * stroke.rms_residual ** 2;
  return [...compare.per_stroke].sort((a, b) => energy(b) - energy(a))[0]?.stroke;
}

/** The picture of a stroke: undefined while it comes, null if there is none. */
export function usePicture(stroke: number | undefined, version: number, compared: unknown, effect = ""): StrokePicture | null | undefined {
  const [picture, setPicture] = useState<StrokePicture | null | undefined>(undefined);
  useLayoutEffect(() => {  // asks before the page is painted
    if (stroke === undefined) return setPicture(null);
    let wanted = true;
    find<StrokePicture>("strokes", { stroke, version, effect }).then((found) => wanted && setPicture(found), () => wanted && setPicture(null));
    return () => { wanted = false; };
  }, [stroke, version, compared, effect]);
  return picture;
}

/** `before`: the same stroke as version `parent` has it; `modelled`: what the picture's own model is called. */
interface Drawn { picture: StrokePicture; before: StrokePicture | null; parent: number; region: Range[]; output: string; modelled?: string }

/** One output at a time where a model has several. */
export function Outputs({ chosen: name, choose, ...drawn }: Drawn & { chosen?: string; choose: (output: string) => void }) {
  const say = useWords();
  const { picture, before } = drawn;
  const chosen = picture.outputs?.find((output) => output.name === name) ?? picture.outputs?.[0];
  const [one, was] = useMemo(() => {
    const of = (from: StrokePicture | null) => { const output = from?.outputs?.find((o) => o.name === chosen?.name); return from && output ? { ...from, ...output, noise: output.measured.map(() => output.noise) } : from; };
    return [of(picture)!, of(before)];
  }, [picture, before, chosen?.name]);
  return (
    <>
      {(picture.outputs?.length ?? 0) > 1 && <label>{say("signalShown")} <select value={chosen!.name} onChange={(e) => choose(e.currentTarget.value)}>
        {picture.outputs!.map((output) => <option key={output.name} value={output.name}>{output.name}</option>)}
      </select></label>}
      <Overlay {...drawn} picture={one} before={was} output={chosen?.name ?? drawn.output} />
    </>
  );
}

/** Measured, modelled and modelled by another version, and below what each leaves. */
function Overlay({ picture, before, parent, region, output, modelled }: Drawn) {
  const say = useWords();
  const regionKey = JSON.stringify(region), hasNoise = picture.noise.length > 0, sparse = picture.outputs !== undefined;
  const data = useMemo(() => {
    const { factor, offset } = shownUnit(picture.unit);
    const inside = region.length > 0 ? insideOf(picture, region) : null;
    const there = (list: (number | null)[]) => (inside ? list.map((v, k) => (inside[k] ? v : null)) : list);
    const of = (list: (number | null)[]) => list.map((v) => (v === null ? null : v * factor + offset));
    const less = (p: StrokePicture) => p.measured.map((v, k) => (v === null || p.modelled[k] === null ? null : (v - p.modelled[k]) * factor));
    const x = picture.measured.map((_, k) => k * picture.step), noise = picture.measured.map((_, k) => 1.96 * (picture.noise[k] ?? 0) * factor);
    const modelled = of(picture.modelled), band = (sign: number) => modelled.map((v, k) => (v === null ? null : v + sign * noise[k]));
    const was = before && before.measured.length === picture.measured.length ? before : null;
    const shades = (inside ? stretchesIn(picture, inside) : []).map((s) => ({ ...s, color: pageColor("--region-shade") }));
    return { x, shades, was: was !== null, faint: inside !== null,
      flows: [there(band(-1)), there(band(1)), of(picture.measured), there(of(picture.measured)), there(modelled), ...(was ? [there(of(was.modelled))] : [])],
      differences: [there(noise.map((n) => -n)), there(noise), there(less(picture)), ...(was ? [there(less(was))] : [])] };
  }, [picture, before, regionKey, unitsKey()]);
  const band = pageColor("--band"), a = pageColor("--line-a"), b = pageColor("--line-b"), ink = pageColor("--line-measured");
  const hidden = { color: "transparent", hidden: true }, unit = nameOf(picture.unit);
  const noise = hasNoise ? { label: say(sparse ? "noiseBandAtMost" : "noiseBand"), color: band } : { label: "low", ...hidden };
  const old = data.was ? [{ label: say("before", { version: parent }), color: b, dashed: true, sparse }] : [];
  const bands = hasNoise ? [{ high: 1, low: 0, color: band }] : [];
  return (
    <>
      <Plot label={`${say("compareTitle")}: ${say("compareStroke")} ${picture.stroke}`} x={data.x} values={data.flows} shades={data.shades} height={270}
        bands={bands} xLabel={`${say("time")} (s)`} yLabel={`${output}${unit && ` (${unit})`}`}
        lines={[noise, { label: "high", ...hidden }, { label: say("elsewhere"), color: data.faint ? pageColor("--edge") : "transparent", width: 1, hidden: !data.faint }, { label: say("measured"), color: ink, width: 1.2, sparse }, { label: modelled ?? say("modelled"), color: a, width: 2 }, ...old]} />
      <Plot label={`${say("difference")}: ${say("compareStroke")} ${picture.stroke}`} x={data.x} values={data.differences} shades={data.shades} height={150}
        bands={bands} xLabel={`${say("time")} (s)`} yLabel={unit}
        lines={[noise, { label: "high", ...hidden }, { label: say("difference"), color: a, sparse }, ...old]} />
    </>
  );
}
