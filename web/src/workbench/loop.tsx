// A machine in closed loop: its frequency response in place of strokes, and what changed of it in place of what is missing.

import { useMemo } from "preact/hooks";
import { Problem, type Failure } from "../failure";
import { Plot, pageColor } from "../plot";
import { Told, ToldList } from "../told";
import type { LoopChanges, LoopResult, LoopSet, Parameter, Session } from "../types";
import { halfText, short, withUnit } from "../units";
import { useWords } from "../words";
import { useParameters } from "./parameters";
import { AsPrinted, CardTable } from "./parts";

const sizesOf = (set: LoopSet) => set.set.map((id) => [id, set.parameters[id]] as const);

/** What it is compared with. */
function useBefore(session: Session): string {
  const say = useWords();
  return session.logs.find((log) => log.held_out)?.name.split("/").pop() ?? say("loopReferences");
}

/** Gain and phase as measured, with their intervals, as the model has them, and as the one before had them. */
export function LoopCompare({ result, changes, session }: { result?: LoopResult; changes?: LoopChanges; session: Session }) {
  const say = useWords(), before = useBefore(session);
  const data = useMemo(() => {
    if (!result) return null;
    const { f_hz, gain, gain_half, phase, phase_half, model_gain, model_phase, before_gain, before_phase } = result.response;
    const of = (value: number[], half: number[], model?: number[], old?: number[]) =>
      [value.map((v, k) => v - half[k]), value.map((v, k) => v + half[k]), value, ...(model ? [model] : []), ...(old ? [old] : [])];
    return { x: f_hz, gain: of(gain, gain_half, model_gain, before_gain), phase: of(phase, phase_half, model_phase, before_phase) };
  }, [result]);
  if (!result || !data) return <p class="empty">{say("loading")}</p>;
  const { model_gain, before_gain } = result.response;
  const lines = [{ label: say("loopBand"), color: pageColor("--band") }, { label: "high", color: "transparent", hidden: true },
    { label: say("measured"), color: pageColor("--line-measured"), width: 1.2 },
    ...(model_gain ? [{ label: say("loopModel"), color: pageColor("--line-a"), width: 2 }] : []),
    ...(before_gain ? [{ label: before, color: pageColor("--line-b"), dashed: true }] : [])];
  const bands = [{ high: 1, low: 0, color: pageColor("--band") }];
  return (
    <>
      <h1>{say("loopTitle")}</h1>
      <p>{say("loopText", { input: result.input, output: result.output, set_point: result.set_point, seconds: short(result.seconds), count: result.response.f_hz.length })}</p>
      {result.model_reason && <p class="verdict bad">{say("loopNoModel")}<Told of={{ text: result.model_reason, german: { text: result.german?.model_reason } }} what="text" /></p>}
      {result.warnings.length > 0 && <div class="verdict bad"><strong>{say("checkHints")}</strong><ul><ToldList of={result.warnings} german={result.german?.warnings} /></ul></div>}
      <Plot label={`${say("bodeGain")}: ${say("loopTitle")}`} x={data.x} values={data.gain} lines={lines} bands={bands} logX xLabel={`${say("frequency")} (Hz)`} yLabel={`${say("bodeGain")} (dB)`} height={260} />
      <Plot label={`${say("bodePhase")}: ${say("loopTitle")}`} x={data.x} values={data.phase} lines={lines} bands={bands} logX xLabel={`${say("frequency")} (Hz)`} yLabel={`${say("bodePhase")} (°)`} height={220} />
      <LoopParameters result={result} changes={changes} session={session} />
      <AsPrinted text={result.text} />
    </>
  );
}

/** The parameters before and now; now alone where nothing is known of before. */
export function LoopParameters({ result, changes, session }: { result?: LoopResult; changes?: LoopChanges; session: Session }) {
  const say = useWords(), before = useBefore(session), { nameOf, meaningOf, valueOf } = useParameters();
  const shown = (name: string, value: { value: number; std: number | null }, unit: string) => valueOf(name, { ...value, std: value.std || null, unit } as Parameter);
  const name = (id: string) => <>{nameOf(id)} <small>{meaningOf(id)}</small></>;
  if (changes)
    return <CardTable label={say("parameter")} heads={[say("parameter"), before, say("now"), say("loopChange")]} keys={Object.keys(changes.parameters)}
      rows={Object.entries(changes.parameters).map(([id, p]) => [name(id), shown(id, p.before, p.unit), shown(id, p.after, p.unit),
        p.relative ? withUnit(`${p.change > 0 ? "+" : ""}${short(100 * p.change, 2)}`, "%") : shown(id, { value: p.change, std: Math.hypot(p.before.std, p.after.std) }, p.unit)])} />;
  if (!result?.model) return null;
  return <CardTable label={say("parameter")} heads={[say("parameter"), say("now")]} keys={Object.keys(result.model)}
    rows={Object.entries(result.model).map(([id, p]) => [name(id), shown(id, p, p.unit)])} />;
}

/** How far the measured gain lies off the model, over frequency. */
export function LoopLocate({ result }: { result?: LoopResult }) {
  const say = useWords();
  const data = useMemo(() => {
    if (!result?.response.model_gain) return null;
    const { f_hz, gain, gain_half, model_gain } = result.response;
    const percent = (decibels: number) => 100 * (10 ** (decibels / 20) - 1), half = gain_half.map(percent);
    return { x: f_hz, values: [half.map((h) => -h), half, gain.map((g, k) => percent(g - model_gain[k]))] };
  }, [result]);
  if (!result) return <p class="empty">{say("loading")}</p>;
  return (
    <>
      <h1>{say("locateTitle")}</h1>
      {!data ? <p class="empty">{say("loopNoModel")}</p> : <>
        <p>{say("loopLocate")}</p>
        <Plot label={say("loopOff")} x={data.x} values={data.values} bands={[{ high: 1, low: 0, color: pageColor("--band") }]} logX height={300}
          lines={[{ label: say("loopBand"), color: pageColor("--band") }, { label: "high", color: "transparent", hidden: true }, { label: say("loopOff"), color: pageColor("--line-a") }]}
          xLabel={`${say("frequency")} (Hz)`} yLabel="%" />
      </>}
    </>
  );
}

/** How large a change is. */
function Size({ id, changes, set }: { id: string; changes: LoopChanges; set: LoopSet }) {
  const say = useWords();
  const size = set.parameters[id];
  if (!size) return changes.input_limit === null ? null : <>{say("loopUpTo", { limit: withUnit(short(changes.input_limit), "A") })}</>;
  return size.unit === "s" ? <>{say("loopLonger", { size: withUnit(halfText(1e3 * size.value, 1.96e3 * size.std), "ms") })}</>
    : <>{say("loopTimes", { size: halfText(size.value, 1.96 * size.std) })}</>;
}

/** What changed, in plain words, and what to look at. */
export function LoopVerdict({ changes, problem, session }: { changes?: LoopChanges; problem?: Failure; session: Session }) {
  const say = useWords(), before = useBefore(session);
  if (problem) return <section class="verdict-panel"><h2>{say("verdictTitle")}</h2><p>{say("loopNeedsBefore")}</p><Problem of={problem} /></section>;
  if (!changes) return <section class="verdict-panel"><h2>{say("verdictTitle")}</h2><p class="empty">{say("verdictComing")}</p></section>;
  const best: LoopSet = { set: changes.set, parameters: changes.changes };
  const words = (set: LoopSet) => sizesOf(set).map(([id], at) => <span key={id}>{at > 0 && " + "}<Told of={changes.known[id]} what="quantity" /> <Size id={id} changes={changes} set={set} /></span>);
  return (
    <section class={`verdict-panel ${changes.verdict}`}>
      <h2>{say("verdictTitle")}</h2>
      <p class="headline" data-verdict={changes.verdict}>{say(changes.reversed ? "loop_reversed" : changes.set.length > 0 && changes.verdict === "adequate" ? "loop_named" : `loop_${changes.verdict}`)}</p>
      <p class="quiet">{say("loopSince", { before })}</p>
      {changes.set.map((id) => (
        <div class="suspect" key={id} data-change={id}>
          <p><strong><Told of={changes.known[id]} what="quantity" />: <Size id={id} changes={changes} set={best} /></strong></p>
          <h3>{say("inspect")}</h3><p><Told of={changes.known[id]} what="sentence" /></p>
        </div>
      ))}
      {changes.others.map((other) => <div class="suspect" key={other.set.join()}><p>{say("loopOr")}{words(other)}</p></div>)}
      {changes.imitators.map((other) => <p key={other.set.join()}>{say("loopImitator")}{words(other)}</p>)}
      {changes.warnings.length > 0 && <details open><summary>{say("warnings")}</summary><ul><ToldList of={changes.warnings} german={changes.german?.warnings} /></ul></details>}
      <AsPrinted text={changes.text} />
      <h2>{say("loopTried")}</h2>
      <CardTable label={say("loopTried")} heads={[say("loopAlone"), say("loopSize"), say("loopLeft")]} keys={changes.ranking.map((one) => one.effect)}
        rows={changes.ranking.map((one) => [<Told of={changes.known[one.effect]} what="quantity" />,
          <Size id={one.effect} changes={changes} set={{ set: [one.effect], parameters: one.parameters }} />, short(one.chi_squared)])} />
    </section>
  );
}
