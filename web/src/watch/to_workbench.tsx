import { post } from "../api";
import { Problem, useAttempt } from "../failure";
import { refresh, useStore } from "../store";
import { useUrl } from "../url_state";
import { useWords } from "../words";

/** Takes strokes of the database to the workbench, where they are looked at like those of a log. */
export function ToWorkbench({ machine, first, last }: { machine: string; first: number; last: number }) {
  const say = useWords();
  const [, setUrl] = useUrl();
  const { session } = useStore();
  const { busy, problem, attempt } = useAttempt();
  if (!session?.workbench || !session.changes) return null;
  const go = async () => {
    if (session.logs.length > 0 && !confirm(say("startOverSure"))) return;
    await attempt(async () => {
      await post("strokes", { machine, first, last });
      await refresh();
      setUrl({ view: "workbench", step: "compare", effect: "" });
    });
  };
  return (
    <div class="to-workbench">
      <button disabled={busy} onClick={() => void go()}>{say("jumpWorkbench")}</button>
      <Problem of={problem} />
    </div>
  );
}
