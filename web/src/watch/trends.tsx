import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { get } from "../api";
import { isEffect } from "../effect_titles";
import { failureOf, Problem, type Failure } from "../failure";
import { pageColor } from "../plot";
import { byFinger } from "../pointer";
import { grouped } from "../units";
import { useUrl } from "../url_state";
import { Told } from "../told";
import { useWords } from "../words";
import type { Words } from "../words/en";
import { OilPlot } from "./oil_plot";
import { celsius, dateText, download, inUnit, isDate, symbolOf } from "./shown";
import { placeOf, type AxisKind } from "./trend_axis";
import { TrendPlot } from "./trend_plot";
import { markColors } from "./trend_view";
import { ToWorkbench } from "./to_workbench";
import { useWatch } from "./watch_store";
import type { MaybeNumber, Overview, Trend, WatchedUnit } from "./watch_types";

const marksShown = 30;
const binsSeen = 1000;  // about a pixel each; beside them as many more as the margins hold, so that panning shows something at once

/** The trends of what is looked at, with a margin on both sides; the last ones stay until the new ones are there. While one pans, `ahead` asks for what comes. */
export function useTrends(machine: string, parameters: string[], from: number, to: number, strokes: number, tick: number) {
  const [trends, setTrends] = useState<Trend[]>([]);
  const [problem, setProblem] = useState<Failure | null>(null);
  const [late, setLate] = useState(false);
  const [moved, setMoved] = useState<{ chosen: string; from: number; to: number } | null>(null);
  const asked = useRef(0), there = useRef(0);
  const chosen = `${from} ${to}`, view = moved?.chosen === chosen ? moved : { from, to };
  useEffect(() => setMoved(null), [chosen]);
  useEffect(() => {
    const number = ++asked.current, margin = view.to - view.from;
    const slow = setTimeout(() => setLate(true), 300);
    const first = Math.max(0, view.from - margin), end = Math.min(strokes, view.to + margin), bins = Math.ceil((binsSeen * (end - first)) / Math.max(1, view.to - view.from));
    void Promise.all(parameters.map((parameter) => get<Trend>("watch/trend", { machine, parameter, first, end, bins })))
      .then((found) => {
        if (number < there.current) return;  // a later answer was faster
        there.current = number;
        setTrends(found);
        setProblem(null);
      })
      .catch((caught) => { if (number === asked.current) setProblem(failureOf(caught)); })
      .finally(() => { clearTimeout(slow); if (number === asked.current) setLate(false); });
    return () => clearTimeout(slow);
  }, [machine, parameters.join(), view.from, view.to, tick]);
  const ahead = (first: number, end: number) => setMoved({ chosen, from: first, to: end });
  return { trends: trends.filter((t) => t.machine === machine && parameters.includes(t.parameter)), problem, late, ahead };
}

function csvOf(trend: Trend, unit: WatchedUnit, from: number, to: number): string {
  const { bins } = trend;
  const number = (value: MaybeNumber) => (value === null ? "" : String(value));
  const rows = bins.first.flatMap((first, k) => {
    if (bins.last[k] < from || first >= to) return [];
    const std = bins.std[k];
    return [[trend.machine, trend.parameter, unit.name, String(first), String(bins.last[k]), number(bins.begin_s[k]), number(bins.end_s[k]),
      number(inUnit(bins.mean[k], unit)), number(inUnit(bins.low[k], unit)), number(inUnit(bins.high[k], unit)),
      std === null ? "" : String(std * Math.abs(unit.factor)), number(celsius(bins.oil_temperature_K[k]))]];
  });
  const quoted = (field: string) => (/[",\n]/.test(field) ? `"${field.replace(/"/g, '""')}"` : field);
  const head = ["machine", "parameter", "unit", "first_stroke", "last_stroke", "begin_s", "end_s", "mean", "lowest", "highest", "std", "oil_temperature_degC"];
  return [head, ...rows].map((row) => row.map(quoted).join(",")).join("\n") + "\n";
}

/** All plots below each other as one picture. */
function savePng(box: HTMLElement, title: string, name: string) {
  const canvases = [...box.querySelectorAll("canvas")];
  const out = document.createElement("canvas");
  const head = 40 * devicePixelRatio;
  out.width = Math.max(...canvases.map((c) => c.width));
  out.height = head + canvases.reduce((sum, c) => sum + c.height, 0);
  const ctx = out.getContext("2d")!;
  ctx.fillStyle = pageColor("--panel");
  ctx.fillRect(0, 0, out.width, out.height);
  ctx.fillStyle = pageColor("--text");
  ctx.font = `${16 * devicePixelRatio}px system-ui`;
  ctx.fillText(title, 12 * devicePixelRatio, 26 * devicePixelRatio);
  let y = head;
  for (const canvas of canvases) { ctx.drawImage(canvas, 0, y); y += canvas.height; }
  out.toBlob((blob) => { if (blob) download(name, blob); });
}

export function Trends({ overview }: { overview: Overview }) {
  const say = useWords();
  const [query, setUrl] = useUrl();
  const { tick, alarms } = useWatch();
  const plots = useRef<HTMLDivElement>(null);
  const machine = overview.machines.find((m) => m.machine === query.machine) ?? overview.machines[0];
  const known = useMemo(() => (machine?.parameters ?? []).filter((p) => p.trend), [machine]);
  const chosen = (query.p ?? "").split(",").filter((p) => known.some((k) => k.parameter === p));
  const parameters = chosen.length > 0 ? chosen : known.slice(0, 1).map((p) => p.parameter);
  const strokes = machine?.strokes ?? 0;
  const whole = (text: string | undefined, otherwise: number) => (text && /^\d+$/.test(text) ? Number(text) : otherwise);
  const to = Math.min(strokes, Math.max(1, whole(query.to, strokes))), from = Math.max(0, Math.min(whole(query.from, 0), to - 1));
  const { trends, problem, late, ahead } = useTrends(machine?.machine ?? "", parameters, from, to, strokes, tick);
  if (!machine || strokes === 0) return <p class="empty" role="status">{say("noMachines")}</p>;
  const axis: AxisKind = query.x === "oil" ? "oil" : query.x === "stroke" || !machine.dated ? "stroke" : "time";
  const compensated = query.comp === "1";
  const compensates = trends.some((t) => t.healthy?.compensates);
  const look = (first: number, end: number) => {
    const a = Math.max(0, Math.min(first, strokes - 2)), b = Math.min(strokes, Math.max(end, a + 2));
    setUrl({ from: a === 0 ? "" : String(a), to: b === strokes ? "" : String(b) });
  };
  const span = to - from;
  const choose = (parameter: string, on: boolean) =>
    setUrl({ p: known.map((k) => k.parameter).filter((p) => (p === parameter ? on : parameters.includes(p))).join(",") });
  const unitOf = (parameter: string) => known.find((k) => k.parameter === parameter)!.unit;
  const name = `${machine.machine.replace(/[^\w-]+/g, "_")}_${parameters.join("_").replace(/[^\w-]+/g, "_")}`;
  /** An alarm of an effect by that, one of a rule by what was found. */
  const called = (mark: Trend["marks"][number]) => {
    const found = isEffect(mark.name) ? undefined : alarms.find((alarm) => alarm.machine === machine.machine && alarm.alarm === mark.name);
    return found ? <Told of={found} what="finding" /> : <Told of={mark} what="name" />;
  };
  const marks = trends[0]?.marks.filter((m) => m.stroke >= from && (m.stroke < to || to === strokes)) ?? [];
  return (
    <section class="trends">
      <h1>{say("view_trends")}</h1>
      <div class="filters">
        {overview.machines.length > 1 && <label>{say("alarm_axis")} <select value={machine.machine} onChange={(e) => setUrl({ machine: e.currentTarget.value, from: "", to: "" })}>
          {overview.machines.map((m) => <option key={m.machine} value={m.machine}>{m.machine}</option>)}
        </select></label>}
        <label>{say("over")} <select value={axis} onChange={(e) => setUrl({ x: e.currentTarget.value })}>
          {machine.dated && <option value="time">{say("axis_time")}</option>}
          <option value="stroke">{say("axis_stroke")}</option>
          <option value="oil">{say("axis_oil")}</option>
        </select></label>
        <label title={compensates ? "" : say("compensateNot")}><input type="checkbox" checked={compensated && compensates} disabled={!compensates || axis === "oil"} onChange={(e) => setUrl({ comp: e.currentTarget.checked ? "1" : "" })} /> {say("compensate")}</label>
        <span class="buttons" role="group" aria-label={say("span")}>
          <button onClick={() => look(from - Math.ceil(span / 2), to - Math.ceil(span / 2))} disabled={from === 0} aria-label={say("earlier")}>◀</button>
          <button onClick={() => look(from + Math.ceil(span / 4), to - Math.ceil(span / 4))} aria-label={say("zoomIn")}>+</button>
          <button onClick={() => look(from - Math.ceil(span / 2), to + Math.ceil(span / 2))} disabled={span === strokes} aria-label={say("zoomOut")}>−</button>
          <button onClick={() => look(from + Math.ceil(span / 2), to + Math.ceil(span / 2))} disabled={to === strokes} aria-label={say("later")}>▶</button>
          <button onClick={() => look(0, strokes)} disabled={span === strokes}>{say("everything")}</button>
          <button onClick={() => look(strokes - Math.min(strokes, 200), strokes)}>{say("newestStrokes", { count: 200 })}</button>
        </span>
        <span class="buttons">
          <button disabled={trends.length === 0} onClick={() => download(`${name}.csv`, new Blob([trends.map((t, k) => csvOf(t, unitOf(t.parameter), from, to).replace(k === 0 ? /^$/ : /^.*\n/, "")).join("")], { type: "text/csv" }))}>CSV</button>
          <button disabled={trends.length === 0} onClick={() => plots.current && savePng(plots.current, `${machine.machine}, ${say("strokeNumbers", { from, to: to - 1 })}`, `${name}.png`)}>PNG</button>
        </span>
        <ToWorkbench machine={machine.machine} first={from} last={to - 1} />
      </div>
      <fieldset class="choose"><legend>{say("parameters")}</legend>
        {known.map((p) => <label key={p.parameter} title={p.unit.meaning}><input type="checkbox" name={`p-${p.parameter}`} checked={parameters.includes(p.parameter)} onChange={(e) => choose(p.parameter, e.currentTarget.checked)} /> {symbolOf(p.unit)}</label>)}
      </fieldset>
      <Problem of={overview.problem ? null : problem} />
      <p class="quiet" role="status">
        {say("strokesOf", { from: grouped(from), to: grouped(to - 1), count: grouped(strokes) })}
        {trends[0] && isDate(trends[0].bins.begin_s[0]) && <> · {dateText(placeOf(from, trends[0], "time"))} – {dateText(placeOf(to - 1, trends[0], "time"))}</>}
        {trends.some((t) => !t.exact) ? ` · ${say("trendGlance")}` : late ? ` · ${say("loading")}` : ""}
      </p>
      <div ref={plots} class="plots" data-exact={trends.length > 0 && trends.every((t) => t.exact) ? "1" : "0"}>
        {trends.map((trend) => axis === "oil"
          ? <OilPlot key={trend.parameter} trend={trend} unit={unitOf(trend.parameter)} height={320} />
          : <TrendPlot key={trend.parameter} trend={trend} unit={unitOf(trend.parameter)} axis={axis} compensated={compensated && Boolean(trend.healthy?.compensates)} from={from} to={to} look={look} ahead={ahead} height={trends.length > 1 ? 230 : 340} />)}
      </div>
      <p class="quiet legend">
        {axis !== "oil" && <><span><i class="key-mean" />{say("keyMean")}</span><span><i class="key-band" />{say("keyBand")}</span><span><i class="key-range" />{say("keyRange")}</span></>}
        {trends.some((t) => t.healthy) && <span><i class="key-healthy" />{say("keyHealthy")}</span>}
      </p>
      {axis !== "oil" && <p class="quiet">{say(byFinger() ? "trendFingers" : "trendKeys")}</p>}
      {marks.length > 0 && <section class="marks"><h2>{say("marks")}</h2><ul>
        {marks.slice(0, marksShown).map((mark) => (
          <li key={`${mark.kind}${mark.stroke}${mark.name}${mark.time_s}`}><span style={{ color: `var(${markColors[mark.kind]})` }}>{say(`mark_${mark.kind}`)}</span>{" "}
            {mark.kind === "alarm" ? <button class="link" onClick={() => setUrl({ view: "alarms", alarm: `${machine.machine}/${mark.name}`, show: "all" })}>{called(mark)}</button> : mark.kind === "valve_check" ? say(`outcome_${mark.name}` as keyof Words) : mark.name && <Told of={mark} what="name" />}
            {isDate(mark.time_s) && ` · ${dateText(mark.time_s)}`}{" · "}{mark.stroke < strokes ? say("strokeNumber", { stroke: mark.stroke }) : say("sinceLast")}{mark.kind !== "alarm" && mark.text && <small> · <Told of={mark} what="text" /></small>}</li>
        ))}
      </ul>{marks.length > marksShown && <p class="quiet">{say("marksMore", { count: marks.length - marksShown })}</p>}</section>}
    </section>
  );
}
