// The response of a valve to a sweep or noise, as `frf` measures it: points with their intervals, the model of them, and what an
// earlier record said.

import { useEffect, useMemo, useState } from "preact/hooks";
import { find } from "../api";
import { failureOf, Problem, type Failure } from "../failure";
import { Plot, pageColor } from "../plot";
import { work } from "../store";
import { Told, ToldList } from "../told";
import type { Session, ValveFigures, ValveOptions, ValvePoint, ValveResult } from "../types";
import { amount, halfText, short, withUnit } from "../units";
import { useWords } from "../words";
import type { Words } from "../words/en";
import { AsPrinted, CardTable } from "./parts";

type Query = Record<string, string>;
const decibels = 20 / Math.LN10;
const usual: ValveOptions = { method: "auto", segment: 0, min_coherence: 0.8, from: 0, to: null, settle: null };
const numbers = ["segment", "min_coherence", "from", "to", "settle"] as const;
const keyOf = (option: string) => `frf_${option}`;

/** How it is to be measured, as the address says. */
function optionsOf(query: Query): ValveOptions {
  const options = { ...usual, method: query[keyOf("method")] ?? usual.method };
  for (const name of numbers) {
    const value = query[keyOf(name)];
    if (value !== undefined && Number.isFinite(Number(value))) (options[name] as number) = Number(value);
  }
  return options;
}

export interface Measured { result: ValveResult | null; problem: Failure | null }
const nothing: Measured = { result: null, problem: null };

/** What the newest log says of the valve, once it is wanted. */
export function useValve(wanted: boolean, session: Session, query: Query): Measured {
  const [state, setState] = useState(nothing);
  const asked = JSON.stringify(optionsOf(query)), version = session.machine?.version, logs = JSON.stringify(session.logs);
  useEffect(() => {
    setState(nothing);
    if (!wanted) return;
    let current = true;
    const look = () => find<ValveResult>("results", { kind: "frf" });
    const load = async () => {
      let result = await look();
      if (!result || JSON.stringify(result.options, Object.keys(usual)) !== asked) {
        await work("frf", JSON.parse(asked) as ValveOptions);
        result = await look();
      }
      if (current) setState({ result, problem: null });
    };
    load().catch((caught) => { if (current) setState({ result: null, problem: failureOf(caught) }); });
    return () => { current = false; };
  }, [wanted, asked, version, logs]);
  return state;
}

/** Points and curves over the same frequencies. */
function drawn(result: ValveResult, of: (point: ValvePoint) => [number, number], curve: "gain" | "phase") {
  const points = new Map(result.points.map((p) => [p.f_hz, of(p)])), x = [...new Set([...points.keys(), ...(result.curve ?? result.before?.curve)?.f_hz ?? []])].sort((a, b) => a - b);
  const at = (value: (of: [number, number]) => number) => x.map((f) => { const p = points.get(f); return p ? value(p) : null; });
  const along = (figures: ValveFigures | null) => {
    if (!figures?.curve) return [];
    const known = new Map(figures.curve.f_hz.map((f, k) => [f, figures.curve![curve][k]]));
    return [x.map((f) => known.get(f) ?? null)];
  };
  return { x, values: [at(([v, half]) => v - half), at(([v, half]) => v + half), at(([v]) => v), ...along(result), ...along(result.before)] };
}
const gainOf = (p: ValvePoint): [number, number] => [decibels * Math.log(p.gain), (1.96 * decibels * p.gain_std) / p.gain];
const phaseOf = (p: ValvePoint): [number, number] => [p.phase_deg, 1.96 * p.phase_std_deg];
const hidden = { label: "", color: "transparent", hidden: true };
const dots = () => ({ color: pageColor("--line-measured"), dots: true });
const bars = () => ({ low: 0, high: 1, color: pageColor("--line-measured") });

/** Gain, phase and coherence as measured, with the model of them. */
export function ValveResponse({ measured: { result, problem }, query, setUrl }: { measured: Measured; query: Query; setUrl: (change: Query) => void }) {
  const say = useWords();
  const data = useMemo(() => result && { gain: drawn(result, gainOf, "gain"), phase: drawn(result, phaseOf, "phase"),
    coherence: { x: result.points.map((p) => p.f_hz), values: [result.points.map((p) => p.coherence)] } }, [result]);
  const before = result?.before;
  const lines = [hidden, hidden, { label: say("valveMeasured"), ...dots() }, ...(result?.curve ? [{ label: say("valveModel"), color: pageColor("--line-a"), width: 2, sparse: true }] : []),
    ...(before?.curve ? [{ label: before.log, color: pageColor("--line-b"), dashed: true, sparse: true }] : [])];
  return (
    <>
      <h1>{say("bode")}</h1>
      {!result || !data ? problem ? <Problem of={problem} before={say("failed")} /> : <p class="empty" role="status">{say("loading")}</p> : <>
        <p>{say(result.method === "sine" ? "valveBySines" : "valveBySpectra", { input: result.input, output: result.output, count: result.points.length, segment: result.segment_length, rate: short(result.sample_rate_hz, 4) })} <Conditions of={result} /></p>
        <Plot label={`${say("bodeGain")}: ${say("bode")}`} {...data.gain} lines={lines} bars={bars()} logX xLabel={`${say("frequency")} (Hz)`} yLabel={`${say("bodeGain")} (dB)`} height={250} />
        <Plot label={`${say("bodePhase")}: ${say("bode")}`} {...data.phase} lines={lines} bars={bars()} logX xLabel={`${say("frequency")} (Hz)`} yLabel={`${say("bodePhase")} (°)`} height={220} />
        <Plot label={`${say("valveCoherence")}: ${say("bode")}`} {...data.coherence} lines={[{ label: say("valveCoherence"), ...dots() }]} logX xLabel={`${say("frequency")} (Hz)`} yLabel={say("valveCoherence")} yRange={[0, 1.05]} height={140} />
        <LeftOut result={result} />
        <ValveParameters result={result} />
        <Points result={result} />
      </>}
      <Options query={query} setUrl={setUrl} />
      {result && <AsPrinted text={result.text} />}
    </>
  );
}

/** At which supply pressure and oil it was recorded, as far as the log says. */
function Conditions({ of }: { of: ValveFigures }) {
  const say = useWords();
  const pressure = of.supply_pressure_pa, oil = of.oil_temperature_k;
  return <>{pressure !== null && `${say("valveSupply")} ${amount(pressure / 1e5, "bar", 4)}. `}{oil !== null && `${say("valveOil")} ${amount(oil - 273.15, "°C")}.`}</>;
}

function LeftOut({ result }: { result: ValveResult }) {
  const say = useWords();
  const counts = Object.entries(result.left_out);
  return counts.length === 0 ? null
    : <p class="quiet">{say("valveLeftOut")} {counts.map(([reason, count]) => `${count} × ${say(`point_${reason}` as keyof Words)}`).join(", ")}</p>;
}

/** One figure: value, standard deviation, whether it lies beyond what was measured. */
interface Figure { value: number; std: number; beyond?: boolean }
const figures = (of: ValveFigures): Record<string, Figure> | null => of.model && {
  f0: of.model.f0_hz, D: of.model.D, K_v: of.model.K_v, T_dead: of.model.T_dead_s,
  bandwidth: { value: of.bandwidth_3db_hz!, std: of.bandwidth_3db_std_hz!, beyond: of.bandwidth_3db_extrapolated },
  phase_90: { value: of.phase_90_hz!, std: of.phase_90_std_hz!, beyond: of.phase_90_extrapolated },
  t90: { value: of.t90_s!, std: of.t90_std_s! },
};
const symbols: Record<string, string> = { f0: "f₀", D: "D", K_v: "Kᵥ", T_dead: "T_dead", bandwidth: "−3 dB", phase_90: "−90°", t90: "t₉₀" };
const unitsOf: Record<string, [number, string]> = { f0: [1, "Hz"], T_dead: [1e3, "ms"], bandwidth: [1, "Hz"], phase_90: [1, "Hz"], t90: [1e3, "ms"] };
function figureText(name: string, { value, std }: Figure): string {
  const [factor, unit] = unitsOf[name] ?? [1, ""];
  return withUnit(halfText(value * factor, 1.96 * std * factor), unit);
}

const surely = 3;  // standard errors: of seven figures one lies beyond them by chance in one of fifty pairs of records

/** The figures of the model, beside those of an earlier record. */
export function ValveParameters({ result }: { result: ValveResult }) {
  const say = useWords();
  const now = figures(result), before = result.before && figures(result.before);
  if (!now) return null;
  const name = (id: string) => <>{symbols[id]} <small>{say(`valve_${id}` as keyof Words)}</small></>;
  const shown = (id: string, figure: Figure) => <>{figureText(id, figure)}{figure.beyond && <small> {say("valveBeyond")}</small>}</>;
  const change = (id: string) => {
    const std = Math.hypot(now[id].std, before![id].std), difference = now[id].value - before![id].value, share = 100 / before![id].value;
    const told = ((id === "T_dead" ? difference : difference * share) > 0 ? "+" : "") + (id === "T_dead" ? figureText(id, { value: difference, std })
      : withUnit(halfText(difference * share, Math.abs(1.96 * std * share)), "%"));
    return Math.abs(difference) > surely * std ? <strong>{told}</strong> : <>{told}</>;
  };
  const ids = Object.keys(now);
  return <>
    <CardTable label={say("parameter")} keys={ids} heads={[say("parameter"), ...(before ? [result.before!.log] : []), before ? result.log : say("checkValue"), ...(before ? [say("loopChange")] : [])]}
      rows={ids.map((id) => [name(id), ...(before ? [shown(id, before[id])] : []), shown(id, now[id]), ...(before ? [change(id)] : [])])} />
    {before && <p class="quiet">{say("valveChangeText")}{[result.before!, result].map((of) => (of.supply_pressure_pa !== null || of.oil_temperature_k !== null) && <span key={of.log}> {of.log}: <Conditions of={of} /></span>)}</p>}
  </>;
}

const mostRows = 40;

function Points({ result }: { result: ValveResult }) {
  const say = useWords();
  const step = Math.ceil(result.points.length / mostRows), shown = result.points.filter((_, k) => k % step === 0), sines = result.method === "sine";
  const heads = ["Hz", say("bodeGain"), `${say("bodePhase")} (°)`, say("valveCoherence"), ...(sines ? [say("valveHarmonics"), say("valvePeriods")] : [])];
  return (
    <details><summary>{say("valvePoints", { count: shown.length, all: result.points.length })}</summary>
      <CardTable label={say("valvePoints", { count: shown.length, all: result.points.length })} heads={heads} keys={shown.map((p) => String(p.f_hz))}
        rows={shown.map((p) => [short(p.f_hz, 5), halfText(p.gain, 1.96 * p.gain_std), halfText(p.phase_deg, 1.96 * p.phase_std_deg), short(p.coherence, 4),
          ...(sines ? [p.distortion === undefined ? "–" : withUnit(short(100 * p.distortion, 2), "%"), short(p.periods)] : [])])} />
    </details>
  );
}

/** How it is measured: the options of `frf`. */
function Options({ query, setUrl }: { query: Query; setUrl: (change: Query) => void }) {
  const say = useWords();
  const units = { segment: say("valveSamples"), min_coherence: "", from: "Hz", to: "Hz", settle: "s" };
  return (
    <details class="valve-options" open={Object.keys(query).some((key) => key.startsWith("frf_"))}><summary>{say("valveOptions")}</summary>
      <label>{say("valve_method")} <select name="frf-method" value={query[keyOf("method")] ?? "auto"} onChange={(e) => setUrl({ [keyOf("method")]: e.currentTarget.value === "auto" ? "" : e.currentTarget.value })}>
        {(["auto", "sine", "welch"] as const).map((method) => <option key={method} value={method}>{say(`valve_method_${method}`)}</option>)}
      </select></label>
      {numbers.map((name) => <label key={name}>{say(`valve_option_${name}`)} <span class="entry"><input name={`frf-${name}`} type="number" min={0} step="any" placeholder={name === "min_coherence" ? short(usual.min_coherence) : say("valveFound")} value={query[keyOf(name)] ?? ""}
        onChange={(e) => setUrl({ [keyOf(name)]: e.currentTarget.value })} /> {units[name]}</span></label>)}
    </details>
  );
}

/** How far the measured points lie off the model. */
export function ValveLocate({ measured: { result, problem } }: { measured: Measured }) {
  const say = useWords();
  const data = useMemo(() => {
    if (!result?.model) return null;
    const { points } = result, x = points.map((p) => p.f_hz);
    const of = (off: (p: ValvePoint) => number, half: (p: ValvePoint) => number) => ({ x, values: [points.map((p) => off(p) - half(p)), points.map((p) => off(p) + half(p)), points.map(off)] });
    return { gain: of((p) => 100 * (p.gain / p.model_gain! - 1), (p) => (196 * p.gain_std) / p.gain), phase: of((p) => p.phase_deg - p.model_phase_deg!, (p) => 1.96 * p.phase_std_deg) };
  }, [result]);
  if (!result) return problem ? <Problem of={problem} before={say("failed")} /> : <p class="empty" role="status">{say("loading")}</p>;
  const lines = [hidden, hidden, { label: say("valveMeasured"), ...dots() }], level = [{ value: 0, color: pageColor("--line-a") }];
  return (
    <>
      <h1>{say("locateTitle")}</h1>
      {!data ? <p class="empty">{say("valveNoModel")}<Reason of={result} /></p> : <>
        <p>{say("valveLocate")}</p>
        <Plot label={say("valveOffGain")} {...data.gain} lines={lines} bars={bars()} levels={level} logX xLabel={`${say("frequency")} (Hz)`} yLabel={`${say("bodeGain")} (%)`} height={240} />
        <Plot label={say("valveOffPhase")} {...data.phase} lines={lines} bars={bars()} levels={level} logX xLabel={`${say("frequency")} (Hz)`} yLabel={`${say("bodePhase")} (°)`} height={240} />
      </>}
    </>
  );
}

function Reason({ of }: { of: ValveResult }) {
  return <Told of={{ text: of.model_reason ?? "", german: { text: of.german?.model_reason } }} what="text" />;
}

/** What the record says of the valve, in plain words. */
export function ValveVerdict({ measured: { result, problem } }: { measured: Measured }) {
  const say = useWords();
  if (!result) return <section class="verdict-panel"><h2>{say("verdictTitle")}</h2>{problem ? <p>{say("valveNothing")}</p> : <p class="empty">{say("valveComing")}</p>}</section>;
  const now = figures(result), misfit = (result.inflation ?? 1) > 1;
  const verdict = !now ? "unknown" : misfit || result.hint || result.first_order || now.phase_90.beyond ? "ambiguous" : "adequate";
  return (
    <section class={`verdict-panel ${verdict}`}>
      <h2>{say("verdictTitle")}</h2>
      <p class="headline" data-verdict={verdict}>{!now ? <>{say("valveNoModel")}<Reason of={result} /></> : say(misfit ? "valveMisfits" : result.first_order ? "valveFirstOrder" : "valveFits", { times: short(result.inflation ?? 1, 3) })}</p>
      {now && <p>{say("valveSays", { bandwidth: figureText("bandwidth", now.bandwidth), phase: figureText("phase_90", now.phase_90), rise: figureText("t90", now.t90) })}{(now.bandwidth.beyond || now.phase_90.beyond) && ` ${say("valveSaysBeyond")}`}</p>}
      {result.hint && <><h3>{say("inspect")}</h3><p><Told of={{ text: result.hint, german: { text: result.german?.hint } }} what="text" /></p></>}
      {result.warnings.length > 0 && <><h3>{say("warnings")}</h3><ul><ToldList of={result.warnings} german={result.german?.warnings} /></ul></>}
      {now && <p class="quiet">{say(result.before ? "valveHealthBeside" : "valveHealth", { before: result.before?.log ?? "" })}</p>}
    </section>
  );
}
