import { useRef } from "preact/hooks";
import { post, upload } from "../api";
import { Problem, useAttempt } from "../failure";
import { refresh } from "../store";
import type { Session } from "../types";
import { useWords } from "../words";

function useChange() {
  const { problem, attempt } = useAttempt();
  const change = (act: () => Promise<unknown>) => void attempt(async () => {
    await act();
    await refresh();
  });
  return { problem, change };
}

/** More logs, and back to the columns of the first. */
export function LogButtons({ session }: { session: Session }) {
  const say = useWords();
  const chooser = useRef<HTMLInputElement>(null);
  const { problem, change } = useChange();
  const reopen = () => { if (session.versions.length < 2 || confirm(say("mapAgainSure"))) change(() => post("reopen")); };
  return (
    <>
      <button class="quiet small no-print" onClick={() => chooser.current?.click()}>{say("logAdd")}</button>
      <input ref={chooser} class="more-logs" type="file" multiple hidden aria-label={say("logAdd")} accept=".csv,.gz,.txt,.dat,.mat"
        onChange={(e) => { for (const file of e.currentTarget.files ?? []) change(() => upload("logs", file)); }} />
      {session.mapped && <button class="quiet small no-print" onClick={reopen}>{say("mapAgain")}</button>}
      <Problem of={problem} />
    </>
  );
}

/** The logs that are worked on: more can be added, and one held out that models are not fitted to. */
export function Logs({ session }: { session: Session }) {
  const say = useWords();
  const { problem, change } = useChange();
  const loop = (session.machine?.closed_loop || session.machine?.valve_alone) ?? false;
  const held = session.logs.find((log) => log.held_out)?.name ?? "";
  return (
    <section class="logs">
      <h2>{say("logs")}</h2>
      <ul>{session.logs.map((log) => <li key={log.name}>{log.name.split("/").pop()}{log.held_out && <em> · {say(loop ? "loopIsBefore" : "logHeldOut")}</em>}</li>)}</ul>
      <LogButtons session={session} />
      {session.logs.length > 1 && (
        <label>{say(loop ? "loopBefore" : "logHoldOut")}{" "}
          <select name="hold-out" value={held} onChange={(e) => { const log = e.currentTarget.value; change(() => post("hold_out", { log })); }}>
            <option value="">{say(session.machine?.closed_loop ? "loopReferences" : "mapNone")}</option>
            {session.logs.map((log) => <option key={log.name} value={log.name}>{log.name.split("/").pop()}</option>)}
          </select>
        </label>
      )}
      <Problem of={problem} />
    </section>
  );
}
