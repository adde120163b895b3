import type { ComponentChildren } from "preact";
import { Told, useTold } from "../told";
import { amount, short } from "../units";
import { CountedIn, useWords } from "../words";
import type { Words } from "../words/en";
import { CardTable, Scroll } from "../workbench/parts";
import { dateText } from "./shown";
import { useAnswer } from "./watch_store";
import type { Overview, ServiceStatus } from "./watch_types";

const lookAgain = 2000;  // ms

/** What the running service tells of itself, asked for every few seconds while one looks. */
export function useService(asked = true): ServiceStatus | null | undefined {
  const found = useAnswer<{ service: ServiceStatus | null }>("watch/service", {}, lookAgain, asked);
  return found === undefined ? undefined : found?.service ?? null;
}

const age = (seconds: number | null) => (seconds === null ? "–" : seconds < 1 ? `${short(1e3 * seconds, 2)} ms` : seconds < 100 ? `${short(seconds, 2)} s` : seconds < 6000 ? `${short(seconds / 60, 2)} min` : `${short(seconds / 3600, 3)} h`);
const memory = (bytes: number) => (bytes < 2 ** 30 ? `${short(bytes / 2 ** 20)} MB` : `${short(bytes / 2 ** 30)} GB`);
/** Names of units as machine files have them, as people read them. */
const si: Record<string, [number, number, string]> = { Pa: [1e-5, 0, "bar"], m: [1e3, 0, "mm"], "m/s": [1e3, 0, "mm/s"], m3: [1e3, 0, "l"], "m3/s": [6e4, 0, "l/min"], K: [1, -273.15, "°C"] };
const value = (number: number | null, unit: string) => { const [factor, offset, name] = si[unit] ?? [1, 0, unit]; return amount(number === null ? null : number * factor + offset, name, 4); };

function Table({ title, heads, rows }: { title: string; heads: string[]; rows: ComponentChildren[][] }) {
  return rows.length === 0 ? null : <section><h2>{title}</h2><CardTable label={title} heads={heads} rows={rows} /></section>;
}

/** Sources, rates, queues, disk and log of the service that writes the database. */
export function Service({ overview }: { overview: Overview }) {
  const service = useService();
  return <CountedIn of={service?.counted}><Status overview={overview} service={service} /></CountedIn>;
}

function Status({ overview, service }: { overview: Overview; service: ServiceStatus | null | undefined }) {
  const say = useWords(), tell = useTold();
  if (service === undefined) return <p class="empty" role="status">{say("loading")}</p>;
  if (service === null) return <section class="service"><h1>{say("view_service")}</h1><p class="empty" role="status">{say("serviceNone")} <code class="command">hydroscope serve MACHINE.toml --db {overview.database}</code></p></section>;
  const { writer, inbox } = service;
  const problems = [tell(writer, "problem"), tell(writer, "begun_anew"), tell(service.drift, "problem")].filter(({ text }) => text !== "");
  const mark = (fine: boolean) => <span class={fine ? "" : "moved"}>{fine ? "✓ " : "✗ "}</span>;
  const lost = inbox.dropped_batches + writer.dropped_rows + writer.dropped_strokes;
  return (
    <section class="service" data-state={service.state}>
      <h1>{say("view_service")}</h1>
      <p>{service.machine} · {say(`running_${service.state}` as keyof Words)} · {say("serviceUp", { time: age(service.uptime_s) })}</p>
      {problems.map(({ text, lang }) => <p key={text} class="problem" role="alert" lang={lang}>{text}</p>)}
      <dl class="facts">
        <div><dt>{say("serviceWriter")}</dt><dd>{say(`writer_${writer.state}` as keyof Words)} · {say("serviceStored", { strokes: writer.strokes, rows: writer.rows })}</dd></div>
        <div><dt>{say("serviceLatency")}</dt><dd>{writer.latency_max_s > 0 ? `${short(1e3 * writer.latency_p50_s)} ms p50, ${short(1e3 * writer.latency_p99_s)} ms p99` : "–"}</dd></div>
        <div><dt>{say("serviceQueues")}</dt><dd>{say("serviceWaiting", { batches: inbox.batches, steps: writer.waiting_items, bytes: memory(writer.waiting_bytes) })}</dd></div>
        <div><dt>{say("serviceLost")}</dt><dd class={lost > 0 ? "moved" : ""}>{say("serviceLostWhat", { batches: inbox.dropped_batches, rows: writer.dropped_rows, strokes: writer.dropped_strokes })}</dd></div>
        <div><dt>{say("serviceDisk")}</dt><dd>{say("serviceDiskWhat", { free: writer.free_bytes > 0 ? memory(writer.free_bytes) : "–", database: writer.database_bytes > 0 ? memory(writer.database_bytes) : "–" })}</dd></div>
        <div><dt>{say("serviceProcess")}</dt><dd>{short(service.cpu_s)} s CPU, {memory(service.memory_bytes)}, {say("serviceFiles", { count: service.descriptors })}</dd></div>
        {service.valve_check && <div><dt>{say("valveChecks")}</dt><dd><Told of={service} what="valve_check" /></dd></div>}
        {service.limits && <div><dt>{say("serviceReload")}</dt><dd><Told of={service} what="limits" /></dd></div>}
      </dl>
      <Table title={say("serviceSources")} heads={[say("serviceSource"), say("alarm_state"), say("serviceAge"), say("serviceRows"), say("serviceLost"), say("serviceReconnects"), say("serviceMalformed")]}
        rows={service.sources.map((s) => [s.name, <>{mark(s.connected)}<Told of={s} what="state" /></>, age(s.age_s), s.rows, s.lost_rows, s.reconnects, s.malformed])} />
      <Table title={say("serviceChannels")} heads={[say("signalShown"), say("serviceRate"), say("serviceAge"), say("tagNow"), say("serviceNoise")]}
        rows={service.channels.map((c) => [c.name, `${short(c.rate_hz)} Hz`, <span class={c.stale ? "moved" : ""}>{age(c.age_s)}</span>, value(c.value, c.unit), c.noise_std === null ? "–" : short(c.noise_std * (si[c.unit]?.[0] ?? 1), 2)])} />
      <Table title={say("serviceAxes")} heads={[say("alarm_axis"), say("experimentStrokes"), say("serviceMissing"), say("serviceLate"), say("serviceGaps")]}
        rows={service.axes.map((a) => [a.name, a.strokes, a.counters.missing_rows, a.counters.late_rows, a.counters.gaps])} />
      <Table title={say("links")} heads={[say("links"), say("alarm_state"), say("clients"), say("behind")]}
        rows={service.feeds.map((f) => [f.name, <>{mark(f.connected)}<Told of={f} what="state" /></>, f.clients, f.behind])} />
      {service.log && service.log.length > 0 && <section><h2>{say("serviceLog")}</h2><p class="quiet">{say("serviceLogText")}</p>
        <Scroll label={say("serviceLog")}><table class="log"><tbody>{[...service.log].reverse().map((line, k) => (
          <tr key={k} class={line.level === "info" ? "" : "moved"}><td>{dateText(line.wall_s)}</td><td>{say(`level_${line.level}` as keyof Words)}</td><td lang="en" class="code">{line.text}</td></tr>))}</tbody></table></Scroll></section>}
    </section>
  );
}
