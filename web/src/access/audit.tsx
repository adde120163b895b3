import { useEffect, useState } from "preact/hooks";
import { get } from "../api";
import { failureOf, Problem, type Failure } from "../failure";
import { useWords } from "../words";
import { dateText } from "../watch/shown";
import { useWatch } from "../watch/watch_store";
import { CardTable } from "../workbench/parts";

interface AuditRow { sequence: number; wall_s: number; user: string; role: string; address: string; what: string; detail: string; outcome: string }

/** What was asked, without braces and quotes. */
function asked(detail: string): string {
  try {
    const { action, machine, alarm, ...more } = JSON.parse(detail) as Record<string, unknown>;
    const rest = Object.entries(more).filter(([, value]) => value !== "" && value !== null).map(([key, value]) => `${key}: ${String(value)}`);
    return [action, [machine, alarm].filter(Boolean).join("/"), ...rest].filter(Boolean).join(" · ");
  } catch {
    return detail;
  }
}

function reason(outcome: string): string {
  try {
    return (JSON.parse(outcome) as { error: string }).error;
  } catch {
    return outcome;
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
            <span lang="en">{row.what}</span>,
            <span lang="en" class="detail-cell">{asked(row.detail)}</span>,
            <span lang="en">{row.outcome ? <span class="moved">{reason(row.outcome)}</span> : "✓"}</span>,
          ])} />
      )}
    </section>
  );
}
