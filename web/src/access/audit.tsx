import { useEffect, useState } from "preact/hooks";
import { get } from "../api";
import { failureOf, Problem, type Failure } from "../failure";
import { Told } from "../told";
import { useWords, type Say } from "../words";
import type { Words } from "../words/en";
import { dateText } from "../watch/shown";
import { useWatch } from "../watch/watch_store";
import { CardTable } from "../workbench/parts";

interface AuditRow { sequence: number; wall_s: number; user: string; role: string; address: string; what: string; detail: string; outcome: string }

/** What rows of the table call a change. */
const changes: Record<string, keyof Words> = {
  login: "auditLogin", "watch/alarms": "auditAlarm", "watch/learning": "auditLearning", "watch/valve_checks": "auditSweep", promote: "auditPromote",
  "user added": "auditAdded", "user removed": "auditRemoved", "password changed": "auditPassword", "role changed": "auditRole",
};
const keys: Record<string, keyof Words> = { comment: "event_commented", user: "who" };
const actions: Record<string, keyof Words> = { acknowledge: "event_acknowledged", shelve: "event_shelved", unshelve: "event_unshelved", comment: "event_commented" };

/** What was asked, without braces and quotes. */
function asked(detail: string, say: Say): string {
  try {
    const { action, machine, alarm, ...more } = JSON.parse(detail) as Record<string, unknown>;
    const rest = Object.entries(more).filter(([, value]) => value !== "" && value !== null).map(([key, value]) => `${keys[key] ? say(keys[key]) : key}: ${String(value)}`);
    return [actions[String(action)] ? say(actions[String(action)]) : action, [machine, alarm].filter(Boolean).join("/"), ...rest].filter(Boolean).join(" · ");
  } catch {
    return detail;
  }
}

/** Why it was not done. */
function Reason({ outcome }: { outcome: string }) {
  const say = useWords();
  if (outcome === "refused") return <>{say("auditRefused")}</>;
  try {
    return <Told of={JSON.parse(outcome) as { error: string }} what="error" />;
  } catch {
    return <span lang="en">{outcome}</span>;
  }
}

/** Who changed what. */
export function Audit() {
  const say = useWords();
  const { tick } = useWatch();
  const [rows, setRows] = useState<AuditRow[] | null>(null);
  const [problem, setProblem] = useState<Failure | null>(null);
  useEffect(() => {
    void get<{ audit: AuditRow[] }>("audit").then(({ audit }) => setRows(audit)).catch((caught) => setProblem(failureOf(caught)));
  }, [tick]);
  return (
    <section class="audit">
      <h1>{say("view_audit")}</h1>
      <p class="quiet">{say("auditText")}</p>
      <Problem of={problem} />
      {rows && (
        <CardTable label={say("view_audit")} keys={rows.map((row) => String(row.sequence))}
          heads={[say("auditWhen"), say("who"), say("auditFrom"), say("auditWhat"), say("auditDetail"), say("outcome")]}
          rows={rows.map((row) => [
            <time>{dateText(row.wall_s)}</time>,
            <>{row.user || "–"}{row.role && row.role !== "nobody" && <small> {say(`role_${row.role as "view"}`)}</small>}</>,
            row.address || say("auditHere"),
            changes[row.what] ? say(changes[row.what]) : <span lang="en">{row.what}</span>,
            asked(row.detail, say) && <span class="detail-cell">{asked(row.detail, say)}</span>,
            row.outcome ? <span class="moved"><Reason outcome={row.outcome} /></span> : "✓",
          ])} />
      )}
    </section>
  );
}
