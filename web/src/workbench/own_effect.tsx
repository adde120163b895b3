import { useEffect, useState } from "preact/hooks";
import { post } from "../api";
import { refresh } from "../store";
import type { MachineInfo } from "../types";
import { Formula } from "../formula";
import { useWords } from "../words";

const pause = 250;  // ms without a key after which what was written is looked at

/** A law that the library does not have, written as an expression over the signals. */
export function OwnEffect({ machine, choose }: { machine: MachineInfo; choose: (effect: string) => void }) {
  const say = useWords();
  const [id, setId] = useState("own_effect");
  const [expression, setExpression] = useState("");
  const [notNegative, setNotNegative] = useState(true);
  const [problem, setProblem] = useState<string | null>(null);
  const written = { id, expression, not_negative: notNegative };
  useEffect(() => {
    if (expression.trim() === "") return setProblem(null);
    let wanted = true;
    const timer = setTimeout(() => {
      post("effect", written).then(() => wanted && setProblem(""), (failure: Error) => wanted && setProblem(failure.message));
    }, pause);
    return () => { wanted = false; clearTimeout(timer); };
  }, [id, expression, notNegative]);
  const keep = async () => {
    try {
      await post("effect", { ...written, keep: true });
      await refresh();
      setExpression("");
      choose(id);
    } catch (failure) {
      setProblem((failure as Error).message);
    }
  };
  if (machine.states) return null;
  return (
    <details class="own">
      <summary>{say("ownTitle")}</summary>
      <p>{say("ownText")} <code>{machine.signals.join("  ")}  ddt(…)  sign(…)  sqrt(…)  exp(…)  max(…, …)</code></p>
      <label>{say("ownName")} <input name="own-id" value={id} onInput={(e) => setId(e.currentTarget.value)} /></label>
      <label>{say("ownExpression")} <input name="own-expression" class="code" value={expression} spellcheck={false} autocomplete="off"
        aria-invalid={problem ? "true" : undefined} aria-describedby="own-says" onInput={(e) => setExpression(e.currentTarget.value)} /></label>
      <label class="tick-box"><input type="checkbox" checked={notNegative} onChange={(e) => setNotNegative(e.currentTarget.checked)} /> {say("ownNotNegative")}</label>
      <div id="own-says" role="status">
        {problem ? <pre class="problem" lang="en">{problem}</pre> : problem === "" && <p class="verdict good">{say("ownFine")} <Formula law={`k ${expression}`} /></p>}
      </div>
      <button class="primary" disabled={problem !== ""} onClick={() => void keep()}>{say("ownTry")}</button>
    </details>
  );
}
