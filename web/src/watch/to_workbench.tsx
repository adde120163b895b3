import { useState } from "preact/hooks";
import { post } from "../api";
import { refresh, useStore } from "../store";
import { useUrl } from "../url_state";
import { useWords } from "../words";

/** Takes strokes of the database to the workbench, where they are looked at like those of a log. */
export function ToWorkbench({ machine, first, last }: { machine: string; first: number; last: number }) {
  const say = useWords();
  const [, setUrl] = useUrl();
  const { session } = useStore();
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState("");
  if (!session?.workbench || !session.changes) return null;
  const go = async () => {
    if (session.logs.length > 0 && !confirm(say("startOverSure"))) return;
    setBusy(true);
    setProblem("");
    try {
      await post("strokes", { machine, first, last });
      await refresh();
      setUrl({ view: "workbench", step: "compare", effect: "" });
    } catch (failure) {
      setProblem((failure as Error).message);
      setBusy(false);
    }
  };
  return (
    <span class="to-workbench">
      <button disabled={busy} onClick={() => void go()}>{say("jumpWorkbench")}</button>
      {problem && <span role="alert" class="problem" lang="en">{problem}</span>}
    </span>
  );
}
