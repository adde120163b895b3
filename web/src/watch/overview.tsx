import { useContext, useEffect, useState } from "preact/hooks";
import { find } from "../api";
import { titleOf } from "../effect_titles";
import { Plot, pageColor } from "../plot";
import { Told, ToldList, useTold } from "../told";
import { amount, inChosen, unitName, grouped, withUnit } from "../units";
import { useUrl } from "../url_state";
import { CountedIn, LanguageContext, useWords } from "../words";
import type { Words } from "../words/en";
import { axisName } from "../workbench/region";
import { severities } from "./alarms";
import { AxisTitle } from "./axis_title";
import { useWatch } from "./watch_store";
import { celsius, dateText, interval, isDate, ofParameter, symbolOf } from "./shown";
import type { Health, MaybeNumber, Overview, StrokeSignals, WatchedMachine, WatchedParameter } from "./watch_types";

/** NE 107: letter, shape and words, not colour alone. */
export function HealthBadge({ health }: { health: Health }) {
  const say = useWords();
  const learning = health.reason === "learning" && health.needed > 0 && health.learned < health.needed;
  return (
    <div class={`health health-${health.letter === "-" ? "good" : health.letter}`}>
      <b aria-hidden="true">{health.letter === "-" ? "✓" : health.letter}</b>
      <span>
        <strong>{learning ? say("healthLearning", { learned: health.learned, needed: health.needed }) : say((health.letter === "-" && !health.live ? "healthGoodThen" : `health_${health.letter}`) as keyof Words)}</strong>
        {!learning && health.reason !== "judged_good" && <small><Told of={{ text: health.text, german: { text: health.german } }} what="text" /></small>}
      </span>
    </div>
  );
}

function Spark({ values }: { values: MaybeNumber[] }) {
  const known = values.filter((v): v is number => v !== null);
  if (known.length < 2) return null;
  const low = Math.min(...known), high = Math.max(...known), span = high - low || 1;
  const points = values.map((v, k) => (v === null ? null : `${((100 * k) / (values.length - 1)).toFixed(1)},${(22 - (20 * (v - low)) / span).toFixed(1)}`));
  return <svg class="spark" viewBox="0 0 100 24" preserveAspectRatio="none" aria-hidden="true"><polyline points={points.filter((p) => p !== null).join(" ")} /></svg>;
}

/** The newest strokes against the healthy machine. */
function Against({ parameter }: { parameter: WatchedParameter }) {
  const say = useWords();
  const reference = parameter.reference;
  if (!reference) return <small class="quiet">{say("noReference")}</small>;
  const factor = parameter.unit.factor;
  const size = reference.percent !== null
    ? withUnit(`${reference.percent >= 0 ? "+" : ""}${interval(reference.percent, (reference.percent_std ?? 0))}`, "%")
    : withUnit(`${(reference.deviation ?? 0) * factor >= 0 ? "+" : ""}${interval((reference.deviation ?? 0) * factor, (reference.std ?? 0) * Math.abs(factor))}`, unitName(parameter.unit));
  return <span class={reference.moved ? "moved" : "quiet"}>{reference.moved && <b>▲ {say("moved")} </b>}{size}</span>;
}

const mostNamed = 3;  // alarms of an axis that its tile names

/** What the alarms of a machine have found, the gravest first. */
function Standing({ machine }: { machine: string }) {
  const say = useWords();
  const [, setUrl] = useUrl();
  const { alarms } = useWatch();
  const standing = alarms.filter((alarm) => alarm.machine === machine && !alarm.at_rest)
    .sort((a, b) => severities.indexOf(a.severity) - severities.indexOf(b.severity)).slice(0, mostNamed);
  if (standing.length === 0) return null;
  return (
    <ul class="standing">{standing.map((alarm) => (
      <li key={alarm.alarm}><span class={`severity severity-${alarm.severity}`}>{say(`severity_${alarm.severity}` as "severity_alarm")}</span> <button class="link" onClick={() => setUrl({ view: "alarms", alarm: `${machine}/${alarm.alarm}` })}><Told of={alarm} what="finding" /></button></li>
    ))}</ul>
  );
}

/** Every parameter with its newest value, its course, and what changed of it. */
function Parameters({ machine }: { machine: WatchedMachine }) {
  const say = useWords(), tell = useTold();
  const [, setUrl] = useUrl();
  return (
    <>
      <table class="cards" role="table">
        <thead><tr role="row"><th scope="col" role="columnheader">{say("parameter")}</th><th scope="col" role="columnheader">{say("newest")}</th><th scope="col" role="columnheader">{say("against")}</th><th scope="col" role="columnheader"><span class="unseen">{say("view_trends")}</span></th></tr></thead>
        <tbody>
          {machine.parameters.map((p) => (
            <tr key={p.parameter} role="row">
              <th scope="row" role="rowheader" class="leads" title={tell(p.unit, p.unit.sentence ? "sentence" : "meaning").text}>
                {p.trend ? <button class="link" onClick={() => setUrl({ view: "trends", machine: machine.machine, p: p.parameter, from: "", to: "" })}>{symbolOf(p.unit)}</button> : <span>{symbolOf(p.unit)}</span>}
                {p.unit.meaning && tell(p.unit, "meaning").text !== symbolOf(p.unit) && <small><Told of={p.unit} what="meaning" /></small>}
              </th>
              <td role="cell" data-label={say("newest")}>{p.trend ? ofParameter(p.value, p.std, p.unit) : "–"}{p.reason === "confounded" && p.reason_text && <small class="quiet"><Told of={{ reason_text: p.reason_text, german: p.german }} what="reason_text" /></small>}</td>
              <td role="cell" data-label={say("against")}><Against parameter={p} /></td>
              <td role="cell" class="spark-cell">{p.spark && <Spark values={p.spark} />}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {machine.warnings.length > 0 && <div class="verdict bad"><strong>{say("checkHints")}</strong><ul><ToldList of={machine.warnings} german={machine.german?.warnings} /></ul></div>}
      {machine.parameters.some((p) => p.reference?.moved) && <p class="quiet"><small>{say("besideFound")}</small></p>}
    </>
  );
}

/** `alone`: one of a few axes, whose parameters are shown, and the signals of its last stroke as they come. */
function Tile({ machine, alone }: { machine: WatchedMachine; alone: boolean }) {
  const say = useWords(), language = useContext(LanguageContext);
  const [, setUrl] = useUrl();
  const oil = celsius(machine.oil_temperature_K);
  return (
    <article class="tile" aria-label={machine.machine}>
      <h2><AxisTitle of={machine.machine} /></h2>
      <HealthBadge health={machine.health} />
      <p class="facts-line">
        {say("strokesCount", { count: grouped(machine.strokes) })}
        {isDate(machine.last_s) && <> · {say("lastStroke", { when: dateText(machine.last_s) })}</>}
        {oil !== null && <> · {say("oil")}{"\u00a0"}{amount(oil, "°C")}</>}
        {machine.effects.length > 0 && <> · <span>+ {machine.effects.map((effect) => titleOf(effect, language)).join(" + ")}</span></>}
      </p>
      {machine.alarms > 0 && <p><button class="link" onClick={() => setUrl({ view: "alarms", axis: machine.machine, alarm: "" })}>{say("alarmsStand", { count: machine.alarms })}</button></p>}
      <Standing machine={machine.machine} />
      {machine.parameters.length > 0 && (alone ? <Parameters machine={machine} />
        : <details><summary>{say("parameters")}</summary><Parameters machine={machine} /></details>)}
      {machine.strokes > 0 && <StrokePicture machine={machine.machine} stroke={machine.strokes - 1} title={say("lastSignals")} begin={alone && machine.health.live} />}
    </article>
  );
}

/** The raw signals of a stroke, as far as they are kept. */
export function StrokePicture({ machine, stroke, title, begin = false }: { machine: string; stroke: number; title: string; begin?: boolean }) {
  const say = useWords();
  const [open, setOpen] = useState(begin);
  const [signals, setSignals] = useState<StrokeSignals | null | "none">(null);
  const [chosen, setChosen] = useState("");
  useEffect(() => {
    if (!open) return;
    let gone = false;
    void find<StrokeSignals>("watch/stroke", { machine, stroke }).catch(() => null).then((found) => { if (!gone) setSignals(found ?? "none"); });
    return () => { gone = true; };
  }, [open, machine, stroke]);
  const picture = signals === null || signals === "none" ? null : signals;
  const signal = picture?.signals.find((s) => s.name === chosen) ?? picture?.signals[0];
  const unit = signal && inChosen(signal.unit);
  return (
    <details class="stroke" open={open} onToggle={(e) => setOpen(e.currentTarget.open)}>
      <summary>{title}</summary>
      {signals === "none" && <p class="empty">{say("signalsNotKept")}</p>}
      {picture && signal && unit && <>
        <label>{say("signalShown")} <select value={signal.name} onChange={(e) => setChosen(e.currentTarget.value)}>
          {picture.signals.map((s) => <option key={s.name} value={s.name}>{s.name}</option>)}
        </select></label>
        <Plot label={`${signal.name}, ${say("stroke")} ${picture.stroke}`} x={picture.time_s.map((t) => t - picture.begin_s)} values={[signal.values.map((v) => (v === null ? null : v * unit.factor + unit.offset))]} height={180}
          lines={[{ label: signal.name, color: pageColor("--line-a") }]} xLabel={`${say("time")} (s)`} yLabel={axisName(signal.name, unit.name)} />
      </>}
    </details>
  );
}

const few = 4;  // axes whose parameters are shown at once, and whose signals are fetched with each of their strokes
const order = "FCSM-";  // the most urgent first

/** How many axes are how. */
function Glance({ machines }: { machines: WatchedMachine[] }) {
  const say = useWords();
  const count = (letter: string) => machines.filter((machine) => machine.health.letter === letter).length;
  return (
    <ul class="glance" aria-label={say("glance")}>{[...order].filter((letter) => count(letter) > 0).map((letter) => (
      <li key={letter} class={`health health-${letter === "-" ? "good" : letter}`}>
        <b aria-hidden="true">{letter === "-" ? "✓" : letter}</b><span><strong>{count(letter)}</strong> {say(`health_${letter}` as keyof Words)}</span>
      </li>))}</ul>
  );
}

export function OverviewPage({ overview }: { overview: Overview }) {
  const say = useWords();
  const { alarms } = useWatch();
  const gravest = (machine: WatchedMachine) => Math.min(severities.length, ...alarms.filter((alarm) => alarm.machine === machine.machine && !alarm.at_rest).map((alarm) => severities.indexOf(alarm.severity)));
  const machines = [...overview.machines].sort((a, b) => order.indexOf(a.health.letter) - order.indexOf(b.health.letter) || gravest(a) - gravest(b));
  return (
    <section class="overview" aria-live="polite">
      <h1>{overview.database}</h1>
      <p class="quiet">{overview.service ? say("serviceRuns") : say("serviceNone")}{!overview.journal && ` ${say("journalNone")}`}</p>
      {overview.presses.filter((press) => press.alarms > 0).map((press) => <p key={press.machine} class="problem">{press.machine}: {say("alarmsStand", { count: press.alarms })}</p>)}
      {machines.length === 0 && <p class="empty">{say("noMachines")}</p>}
      {machines.length > few && <Glance machines={machines} />}
      <div class={machines.length > few ? "tiles many" : "tiles"}>{machines.map((machine) => (
        <CountedIn key={machine.machine} of={machine.counted}><Tile machine={machine} alone={machines.length <= few} /></CountedIn>))}</div>
    </section>
  );
}
