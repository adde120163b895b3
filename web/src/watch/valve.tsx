import { useEffect, useMemo, useRef } from "preact/hooks";
import uPlot from "uplot";
import { post } from "../api";
import { Problem, useAttempt } from "../failure";
import { axisLook, isRound, keepDrawn, pageColor } from "../plot";
import { useStore } from "../store";
import { Told } from "../told";
import { nameOf, short, shownNumber } from "../units";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import type { Words } from "../words/en";
import { CardTable } from "../workbench/parts";
import { dateText, interval, isDate } from "./shown";
import { tickTexts } from "./trend_axis";
import type { Figure, MaybeNumber, Overview, ValveCheck } from "./watch_types";
import { useService } from "./service";
import { useAnswer } from "./watch_store";

const mostCurves = 6;  // of the checks, evenly over the years, the first and the last among them

/** Response of the identified second-order model with dead time: gain in dB about that at rest, phase in degrees. */
function responseOf(check: ValveCheck, hertz: number): { gain: number; phase: number } {
  const ratio = hertz / check.f0_hz.value!, real = 1 - ratio * ratio, imaginary = 2 * check.damping.value! * ratio;
  const delay = 360 * hertz * (check.dead_time_s.value ?? 0);
  return { gain: -10 * Math.log10(real * real + imaginary * imaginary), phase: (-180 / Math.PI) * Math.atan2(imaginary, real) - delay };
}

/** From the oldest, pale, to the newest in the page's line colour. */
function colorOf(k: number, count: number): string {
  return k === count - 1 ? pageColor("--line-b") : `color-mix(in srgb, ${pageColor("--line-a")} ${30 + (70 * k) / Math.max(1, count - 1)}%, ${pageColor("--panel")})`;
}

/** A plot that is drawn anew when its box, its data or the colours change. */
function Drawn({ label, options, data, height }: { label: string; options: () => Omit<uPlot.Options, "width" | "height">; data: uPlot.AlignedData; height: number }) {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const place = box.current;
    return place ? keepDrawn(place, (width) => new uPlot({ ...options(), width, height }, data, place)) : undefined;
  }, [data, height]);
  return <div ref={box} class="trend-plot" role="img" aria-label={label} />;
}

function Bode({ checks }: { checks: ValveCheck[] }) {
  const say = useWords();
  const { data, shown } = useMemo(() => {
    const step = Math.max(1, (checks.length - 1) / (mostCurves - 1));
    const shown = checks.length <= mostCurves ? checks : Array.from({ length: mostCurves }, (_, k) => checks[Math.round(k * step)]);
    const top = 4 * Math.max(...shown.map((c) => c.f0_hz.value!));
    const hertz = Array.from({ length: 160 }, (_, k) => (top / 400) * 400 ** (k / 159));
    return { shown, data: { gain: [hertz, ...shown.map((c) => hertz.map((f) => responseOf(c, f).gain))], phase: [hertz, ...shown.map((c) => hertz.map((f) => responseOf(c, f).phase))] } };
  }, [checks]);
  const options = (y: string) => () => ({
    pxAlign: 0 as const,
    scales: { x: { time: false, distr: 3 as const, range: [data.gain[0][0], data.gain[0][data.gain[0].length - 1]] as [number, number] } },
    axes: [{ ...axisLook(), label: `${say("frequency")} (Hz)`, size: 40, labelSize: 18, values: (_: uPlot, ticks: number[]) => ticks.map((t) => (isRound(t) ? short(t, 2) : "")) },
      { ...axisLook(), label: y, size: 62, labelSize: 20, values: (_: uPlot, ticks: number[]) => ticks.map((t) => short(t, 4)) }],
    series: [{}, ...shown.map((_, k) => ({ stroke: colorOf(k, shown.length), width: k === shown.length - 1 ? 2.4 : 1.6, points: { show: false } }))],
    legend: { show: false }, cursor: { sync: { key: "bode" }, drag: { x: false, y: false } },
  });
  return <>
    <Drawn label={say("bodeGain")} data={data.gain as uPlot.AlignedData} height={230} options={options(`${say("bodeGain")} (dB)`)} />
    <Drawn label={say("bodePhase")} data={data.phase as uPlot.AlignedData} height={230} options={options(`${say("bodePhase")} (°)`)} />
    <p class="legend quiet">{shown.map((check, k) => <span key={check.time_s}><i class="key-line" style={{ borderTopColor: colorOf(k, shown.length) }} />{isDate(check.time_s) ? dateText(check.time_s) : `${short(check.time_s, 5)} s`}</span>)}</p>
  </>;
}

function Bandwidth({ checks }: { checks: ValveCheck[] }) {
  const say = useWords();
  const dated = checks.every((c) => isDate(c.time_s));
  const data = useMemo(() => {
    const bound = (c: ValveCheck, sign: number): MaybeNumber => (c.bandwidth_hz.value === null ? null : c.bandwidth_hz.value + sign * 1.96 * (c.bandwidth_hz.std ?? 0));
    return [checks.map((c) => c.time_s!), checks.map((c) => bound(c, -1)), checks.map((c) => bound(c, 1)), checks.map((c) => c.bandwidth_hz.value)] as uPlot.AlignedData;
  }, [checks]);
  return <Drawn label={say("bandwidth")} data={data} height={220} options={() => ({
    scales: { x: { time: dated } },
    axes: [{ ...axisLook(), size: 46, space: 90, values: (_, ticks, _a, _s, step) => (dated ? tickTexts(ticks, step) : ticks.map((t) => short(t, 5))) },
      { ...axisLook(), label: `${say("bandwidth")} (Hz)`, size: 62, labelSize: 20, values: (_, ticks) => ticks.map((t) => short(t, 4)) }],
    series: [{}, { stroke: "transparent", points: { show: false } }, { stroke: "transparent", points: { show: false } }, { stroke: pageColor("--line-a"), width: 1.8, points: { show: true, size: 6 } }],
    bands: [{ series: [2, 1], fill: pageColor("--band") }], legend: { show: false }, cursor: { drag: { x: false, y: false } },
  })} />;
}

/** Has the running service ask the controller for a sweep, and says what it does about it. */
function AskForSweep({ machine, service }: { machine: string; service: boolean }) {
  const say = useWords();
  const { session } = useStore();
  const told = useService(service);
  const { problem, attempt } = useAttempt();
  const ask = async () => {
    if (confirm(say("valveSure"))) await attempt(() => post("watch/valve_checks", { machine }));
  };
  return (
    <div class="ask">
      {session?.changes && <button name="sweep" disabled={!service} title={service ? "" : say("serviceNone")} onClick={() => void ask()}>{say("valveAsk")}</button>}{" "}
      <span role="status">{!service ? <span class="quiet">{say("valveNoService")}</span> : told?.valve_check && <span data-told><Told of={told} what="valve_check" /></span>}</span>
      <Problem of={problem} />
    </div>
  );
}

/** What the valve answered to the sweeps it was asked for. */
export function Valve({ overview }: { overview: Overview }) {
  const say = useWords();
  const [query, setUrl] = useUrl();
  const machine = overview.machines.find((m) => m.machine === query.machine) ?? overview.machines[0];
  const found = useAnswer<{ valve_checks: ValveCheck[] }>("watch/valve_checks", { machine: machine?.machine ?? "" }, undefined, machine !== undefined);
  if (!machine) return <p class="empty">{say("noMachines")}</p>;
  const checks = found?.valve_checks ?? [], newest = [...checks].reverse();
  const measured = checks.filter((c) => c.outcome === "measured" && c.f0_hz.value !== null && c.damping.value !== null && c.time_s !== null);
  const cell = (figure: Figure, factor = 1) => interval(figure.value === null ? null : figure.value * factor, figure.std === null ? null : figure.std * factor);
  return (
    <section class="valve">
      <h1>{say("view_valve")}</h1>
      {overview.machines.length > 1 && <label>{say("alarm_axis")} <select value={machine.machine} onChange={(e) => setUrl({ machine: e.currentTarget.value })}>
        {overview.machines.map((m) => <option key={m.machine} value={m.machine}>{m.machine}</option>)}
      </select></label>}
      <AskForSweep machine={machine.machine} service={overview.service} />
      {found === undefined ? <p class="empty" role="status">{say("loading")}</p> : checks.length === 0 ? <p class="empty" role="status">{say("valveNone")}</p> : <>
        {measured.length > 1 && <div class="plots"><h2>{say("bandwidth")}</h2><Bandwidth checks={measured} /></div>}
        {measured.length > 0 && <div class="plots bode"><h2>{say("bode")}</h2><Bode checks={measured} /></div>}
        <h2>{say("valveChecks")}</h2>
        <CardTable label={say("valveChecks")} keys={newest.map((check) => String(check.time_s))}
          heads={[say("valveWhen"), say("outcome"), `${say("bandwidth")} (Hz)`, "f₀ (Hz)", "D", say("gain"), `${say("deadTime")} (ms)`, `${say("oil")} (${nameOf("°C")})`]}
          rows={newest.map((check) => [
            isDate(check.time_s) ? dateText(check.time_s) : `${short(check.time_s, 6)} s`,
            <span>{say(`outcome_${check.outcome}` as keyof Words)}{check.outcome !== "measured" && <small> <Told of={check} what="detail" /></small>}</span>,
            cell(check.bandwidth_hz), cell(check.f0_hz), cell(check.damping), cell(check.gain), cell(check.dead_time_s, 1e3),
            short(check.oil_temperature_K === null ? null : shownNumber(check.oil_temperature_K - 273.15, "°C")),
          ])} />
      </>}
    </section>
  );
}
