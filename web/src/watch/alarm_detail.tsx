import { useState } from "preact/hooks";
import { post } from "../api";
import { Problem, useAttempt } from "../failure";
import { useStore } from "../store";
import { useTyped } from "../typed";
import { useUrl } from "../url_state";
import { Told } from "../told";
import { useWords } from "../words";
import type { Words } from "../words/en";
import { sinceText, sizeText } from "./alarms";
import { StrokePicture } from "./overview";
import { ToWorkbench } from "./to_workbench";
import { dateText, isDate } from "./shown";
import { refreshWatch, useAnswer } from "./watch_store";
import type { Alarm, JournalRow } from "./watch_types";

const shelves = [["8", 8 * 3600], ["24", 24 * 3600], ["168", 7 * 24 * 3600]] as const;

/** What was found, on what it rests, what to do; and what a person does about it. `database`: where it was found. */
export function AlarmDetail({ alarm, user, database, close }: { alarm: Alarm; user: string; database: string; close: () => void }) {
  const say = useWords();
  const [, setUrl] = useUrl();
  const { session } = useStore();
  const rows = useAnswer<{ journal: JournalRow[] }>("watch/journal", { machine: alarm.machine, alarm: alarm.alarm })?.journal ?? [];
  const [who, setWho] = useState(localStorage.getItem("who") ?? user);
  const [comment, setComment] = useTyped(`alarm comment ${alarm.machine}/${alarm.alarm}`);
  const [seconds, setSeconds] = useState<number>(shelves[0][1]);
  const { busy, problem, attempt } = useAttempt();
  const act = (action: string, more: object = {}) => attempt(async () => {
    localStorage.setItem("who", who);
    await post("watch/alarms", { action, machine: alarm.machine, alarm: alarm.alarm, user: who, comment, ...more });
    setComment("");
    await refreshWatch(true);
  });
  const reason = comment.trim() !== "";
  const has_strokes = alarm.first_stroke >= 0 && alarm.last_stroke >= alarm.first_stroke;
  const toTrend = () => {
    const span = Math.max(50, alarm.last_stroke - alarm.first_stroke);
    setUrl({ view: "trends", machine: alarm.machine, from: String(Math.max(0, alarm.first_stroke - span)), to: String(alarm.last_stroke + Math.ceil(span / 4)) });
  };
  return (
    <article class="detail work-order" aria-label={alarm.alarm} data-state={alarm.state}>
      <p class="print-only">{say("workOrder")} · {say("orderFor", { machine: alarm.machine.split("/")[0], database })} · {say("printed", { when: dateText(Date.now() / 1000) })}</p>
      <header><h2><Told of={alarm} what="finding" /></h2><button class="quiet no-print" onClick={close}>{say("close")}</button></header>
      <dl class="facts">
        <div><dt>{say("alarm_axis")}</dt><dd>{alarm.machine}</dd></div>
        <div><dt>{say("alarm_state")}</dt><dd>{alarm.state} · {say(`state_${alarm.state}` as "state_UNACK")}{isDate(alarm.shelved_until_s) && ` · ${say("shelvedUntil", { when: dateText(alarm.shelved_until_s) })}`}</dd></div>
        <div><dt>{say("alarm_severity")}</dt><dd>{say(`severity_${alarm.severity}`)}</dd></div>
        <div><dt>{say("alarm_since")}</dt><dd>{sinceText(alarm, say)}</dd></div>
        <div><dt>{say("alarm_size")}</dt><dd>{sizeText(alarm)}</dd></div>
        {alarm.evidence && <div><dt>{say("evidence")}</dt><dd><Told of={alarm} what="evidence" /></dd></div>}
        <div><dt>{say("alarm_cause")}</dt><dd>{alarm.cause ? <Told of={alarm} what="cause" /> : "–"}</dd></div>
        {alarm.action && <div><dt>{say("whatToDo")}</dt><dd><strong><Told of={alarm} what="action" /></strong></dd></div>}
      </dl>
      {has_strokes && <div class="no-print jump">
        <button onClick={toTrend}>{say("jumpTrend", { from: alarm.first_stroke, to: alarm.last_stroke })}</button>
        <ToWorkbench machine={alarm.machine} first={alarm.first_stroke} last={alarm.last_stroke} />
        <StrokePicture machine={alarm.machine} stroke={alarm.last_stroke} title={say("jumpStroke", { stroke: alarm.last_stroke })} />
      </div>}
      {!session?.changes ? <p class="no-print buttons">{session?.user ? say("onlyView") : <button class="primary" onClick={() => setUrl({ view: "login" })}>{say("loginToActOn")}</button>} <button onClick={() => print()}>{say("printOrder")}</button></p> : <div class="no-print act">
        {session.login ? <p>{say("actAs", { user: session.user!.name })}</p>
          : <label>{say("who")} <input name="who" value={who} maxLength={100} onInput={(e) => setWho(e.currentTarget.value)} /></label>}
        <label class="wide">{say("comment")} <textarea name="comment" rows={2} maxLength={2000} value={comment} onInput={(e) => setComment(e.currentTarget.value)} /></label>
        <div class="buttons">
          <button class="primary" disabled={busy || alarm.acknowledged} onClick={() => void act("acknowledge")}>{say("acknowledge")}</button>
          {alarm.shelved_until_s === null
            ? <span class="shelf"><select aria-label={say("shelfTime")} value={seconds} onChange={(e) => setSeconds(Number(e.currentTarget.value))}>
                {shelves.map(([hours, s]) => <option key={hours} value={s}>{say("hours", { hours })}</option>)}
              </select> <button disabled={busy || !reason} title={reason ? "" : say("shelfNeedsReason")} onClick={() => void act("shelve", { seconds })}>{say("shelve")}</button></span>
            : <button disabled={busy} onClick={() => void act("unshelve")}>{say("unshelve")}</button>}
          <button disabled={busy || !reason} onClick={() => void act("comment")}>{say("commentSave")}</button>
          <button onClick={() => print()}>{say("printOrder")}</button>
        </div>
        {!reason && alarm.shelved_until_s === null && <small>{say("shelfNeedsReason")}</small>}
        <Problem of={problem} />
      </div>}
      <h3>{say("journal")}</h3>
      <ol class="journal">
        {rows.slice(0, 50).map((row) => (
          <li key={row.sequence}><time>{dateText(row.wall_s)}</time> {say(`event_${row.event}` as keyof Words)}{row.state_before !== row.state && <> ({row.state_before} → {row.state})</>}
            {row.user && <> · {row.user}</>}{row.comment && <> · “{row.comment}”</>}</li>
        ))}
      </ol>
      <div class="print-only done"><p>{say("orderDone")}</p><p>{say("orderBy")}</p><p>{say("orderDate")}</p></div>
    </article>
  );
}
