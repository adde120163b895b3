import { useMemo, useState } from "preact/hooks";
import { useUrl } from "../url_state";
import { Told } from "../told";
import { CountedIn, useWords, type Say } from "../words";
import { Scroll } from "../workbench/parts";
import { AlarmDetail } from "./alarm_detail";
import { AxisTitle } from "./axis_title";
import { inChosen, unitName, withUnit } from "../units";
import { dateText, interval, isDate } from "./shown";
import type { Alarm, Overview } from "./watch_types";
import { useWatch } from "./watch_store";

export const severities = ["signal_loss", "alarm", "warning", "advisory"] as const;
const columns = ["state", "severity", "since", "axis", "finding", "size", "cause"] as const;
type Column = (typeof columns)[number];

/** When an alarm was raised, in the words of its machine. */
function Since({ alarm }: { alarm: Alarm }) {
  return <>{sinceText(alarm, useWords())}</>;
}

export function sinceText(alarm: Alarm, say: Say): string {
  if (isDate(alarm.raised_time_s)) return dateText(alarm.raised_time_s);
  if (alarm.raised_stroke > 0) return say("strokeNumber", { stroke: alarm.raised_stroke });
  return alarm.raised_wall_s > 0 ? dateText(alarm.raised_wall_s) : "–";
}

/** Size in the alarm's own unit; where that has no name people know, the finding tells it. */
export function sizeText(alarm: Alarm): string {
  if (alarm.value === null || alarm.unit === "") return "–";
  const { factor, name } = inChosen({ ...alarm.shown, offset: 0 });
  return withUnit(interval(alarm.value * factor, alarm.std === null ? null : alarm.std * Math.abs(factor)), unitName({ name }));
}

function keyOf(alarm: Alarm, column: Column): string | number {
  switch (column) {
    case "state": return alarm.at_rest ? 9 : ["UNACK", "RTNUN", "ACKED", "LTUNK", "LTACK", "SHLVD", "DSUPR", "OOSRV"].indexOf(alarm.state);
    case "severity": return severities.indexOf(alarm.severity);
    case "since": return -(alarm.raised_time_s ?? alarm.raised_stroke);
    case "axis": return alarm.machine;
    case "finding": return alarm.finding;
    case "size": return -Math.abs((alarm.value ?? 0) / (alarm.limit || 1));
    case "cause": return alarm.cause;
  }
}

export function Alarms({ overview }: { overview: Overview }) {
  const say = useWords();
  const [query, setUrl] = useUrl();
  const { alarms } = useWatch();
  const [text, setText] = useState("");
  const sort = columns.find((c) => c === query.sort) ?? "state";
  const axes = useMemo(() => [...new Set(alarms.map((a) => a.machine))].sort(), [alarms]);
  const shown = alarms.filter((a) =>
    (query.show === "all" || !a.at_rest) && (!query.axis || a.machine === query.axis) && (!query.severity || a.severity === query.severity) &&
    (!query.state || a.state === query.state) && `${a.machine} ${a.alarm} ${a.text} ${a.cause} ${a.german?.finding ?? ""}`.toLowerCase().includes(text.toLowerCase()));
  const falling = query.order === "down";
  shown.sort((a, b) => {
    const x = keyOf(a, sort), y = keyOf(b, sort);
    const order = x < y ? -1 : x > y ? 1 : keyOf(a, "severity") < keyOf(b, "severity") ? -1 : 1;
    return falling ? -order : order;
  });
  const countedOf = (machine: string) => overview.machines.find((m) => m.machine === machine)?.counted;
  const chosen = alarms.find((a) => `${a.machine}/${a.alarm}` === query.alarm);
  const choice = (key: string, label: string, values: readonly string[], name: (value: string) => string, all: string) => (
    <label>{label} <select value={query[key] ?? ""} onChange={(e) => setUrl({ [key]: e.currentTarget.value })}>
      <option value="">{all}</option>{values.map((value) => <option key={value} value={value}>{name(value)}</option>)}
    </select></label>
  );
  return (
    <section class="alarms">
      <h1>{say("view_alarms")}</h1>
      <div class="filters">
        {choice("show", say("alarmShow"), ["all"], () => say("alarmShowAll"), say("alarmShowStanding"))}
        {choice("axis", say("alarm_axis"), axes, (v) => v, say("all"))}
        {choice("severity", say("alarm_severity"), severities, (v) => say(`severity_${v}` as "severity_alarm"), say("all"))}
        {choice("state", say("alarm_state"), ["UNACK", "ACKED", "RTNUN", "SHLVD", "DSUPR", "OOSRV"], (v) => `${v} · ${say(`state_${v}` as "state_UNACK")}`, say("all"))}
        <label>{say("search")} <input type="search" value={text} onInput={(e) => setText(e.currentTarget.value)} /></label>
      </div>
      {shown.length === 0 ? <p class="empty" role="status">{alarms.length === 0 ? say("alarmsNone") : say("alarmsNoneShown")}</p> : (
        <Scroll label={say("view_alarms")}>
          <table class="alarm-table cards" role="table">
            <thead><tr role="row">{columns.map((column) => (
              <th key={column} scope="col" role="columnheader" aria-sort={sort === column ? (falling ? "descending" : "ascending") : undefined}>
                <button class="quiet small" onClick={() => setUrl({ sort: column, order: sort === column && !falling ? "down" : "" })}>{say(`alarm_${column}`)}{sort === column && (falling ? " ▼" : " ▲")}</button>
              </th>))}</tr></thead>
            <tbody>{shown.map((alarm) => {
              const key = `${alarm.machine}/${alarm.alarm}`;
              return (
                <tr key={key} role="row" class={key === query.alarm ? "chosen" : ""}>
                  <td role="cell"><span class={`state state-${alarm.state}`} title={alarm.state}>{say(`state_${alarm.state}` as "state_UNACK")}</span></td>
                  <td role="cell"><span class={`severity severity-${alarm.severity}`}>{say(`severity_${alarm.severity}`)}</span></td>
                  <td role="cell" data-label={say("alarm_since")}><CountedIn of={countedOf(alarm.machine)}><Since alarm={alarm} /></CountedIn></td>
                  <td role="cell" class="axis" data-label={say("alarm_axis")}><AxisTitle of={alarm.machine} /></td>
                  <td role="cell" class="leads"><button class="link" data-alarm={key} onClick={() => setUrl({ alarm: key })}><Told of={alarm} what="finding" /></button></td>
                  <td role="cell" data-label={say("alarm_size")}>{sizeText(alarm)}</td>
                  <td role="cell" data-label={say("alarm_cause")}>{alarm.cause ? <Told of={alarm} what="cause" /> : "–"}</td>
                </tr>
              );
            })}</tbody>
          </table>
        </Scroll>
      )}
      {chosen && <CountedIn of={countedOf(chosen.machine)}><AlarmDetail key={query.alarm} alarm={chosen} user={overview.user} database={overview.database} close={() => setUrl({ alarm: "" })} /></CountedIn>}
    </section>
  );
}
