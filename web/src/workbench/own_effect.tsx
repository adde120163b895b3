import { useState } from "preact/hooks";
import { post } from "../api";
import { failureOf } from "../failure";
import { Formula } from "../formula";
import { TermPlot, useLaw } from "../law";
import { refresh } from "../store";
import { Told } from "../told";
import type { MachineInfo } from "../types";
import { useTyped } from "../typed";
import type { Units } from "../units";
import { useWords } from "../words";

/** A law that the library does not have, written as an expression over the signals. */
export function OwnEffect({ machine, units, choose }: { machine: MachineInfo; units: Units; choose: (effect: string) => void }) {
  const say = useWords();
  const [id, setId] = useTyped("own effect", "own_effect");
  const [expression, setExpression] = useTyped("own expression");
  const [notNegative, setNotNegative] = useState(true);
  const written = { id, expression, not_negative: notNegative };
  const { problem, course, setProblem } = useLaw(written);
  const keep = async () => {
    try {
      await post("effect", { ...written, keep: true });
      await refresh();
      setExpression("");
      choose(id);
    } catch (caught) {
      setProblem(failureOf(caught));
    }
  };
  const [opened] = useState(expression !== "");
  if (machine.states) return null;
  const wrong = problem === "none" ? null : problem;
  return (
    <details class="own" open={opened}>
      <summary>{say("ownTitle")}</summary>
      <p>{say("ownText")} <code>{machine.signals.join("  ")}  ddt(…)  sign(…)  sqrt(…)  exp(…)  max(…, …)</code></p>
      <label>{say("ownName")} <input name="own-id" value={id} onInput={(e) => setId(e.currentTarget.value)} /></label>
      <label>{say("ownExpression")} <input name="own-expression" class="code" value={expression} spellcheck={false} autocomplete="off"
        aria-invalid={wrong ? "true" : undefined} aria-describedby="own-says" onInput={(e) => setExpression(e.currentTarget.value)} /></label>
      <label class="tick-box"><input type="checkbox" checked={notNegative} onChange={(e) => setNotNegative(e.currentTarget.checked)} /> {say("ownNotNegative")}</label>
      <div id="own-says" role="status">
        {wrong ? <pre class="problem"><Told of={wrong} what="error" /></pre> : problem === "none" && <p class="verdict good">{say("ownFine")} <Formula law={`k ${expression}`} /></p>}
      </div>
      {course && <TermPlot course={course} expression={expression} units={units} />}
      <button class="primary" disabled={problem !== "none"} onClick={() => void keep()}>{say("ownTry")}</button>
    </details>
  );
}
