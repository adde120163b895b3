import { useEffect, useMemo, useState } from "preact/hooks";
import { post } from "../api";
import { failureOf, type Failure } from "../failure";
import { refresh } from "../store";
import type { MachineInfo } from "../types";
import { Formula } from "../formula";
import { pageColor, Plot } from "../plot";
import { Told } from "../told";
import { useTyped } from "../typed";
import { unitName, unitOf, type Units } from "../units";
import { useWords } from "../words";

const pause = 250;  // ms without a key after which what was written is looked at

/** The term over a stroke, SI; null between stretches of it. */
interface Course { stroke: number; step: number; values: (number | null)[]; unit: string }

/** A law that the library does not have, written as an expression over the signals. */
export function OwnEffect({ machine, units, choose }: { machine: MachineInfo; units: Units; choose: (effect: string) => void }) {
  const say = useWords();
  const [id, setId] = useTyped("own effect", "own_effect");
  const [expression, setExpression] = useTyped("own expression");
  const [notNegative, setNotNegative] = useState(true);
  const [problem, setProblem] = useState<Failure | "none" | null>(null);  // null: nothing was written
  const [course, setCourse] = useState<Course | null>(null);
  const written = { id, expression, not_negative: notNegative };
  useEffect(() => {
    if (expression.trim() === "") { setCourse(null); return setProblem(null); }
    let wanted = true;
    const says = (wrong: Failure | "none", there: Course | null) => { if (wanted) { setProblem(wrong); setCourse(there); } };
    const timer = setTimeout(() => {
      post<{ course: Course | null }>("effect", written).then((answer) => says("none", answer.course), (caught) => says(failureOf(caught), null));
    }, pause);
    return () => { wanted = false; clearTimeout(timer); };
  }, [id, expression, notNegative]);
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

/** What the expression gives over the stroke that the model errs most on, while it is being written. */
function TermPlot({ course, expression, units }: { course: Course; expression: string; units: Units }) {
  const say = useWords();
  const unit = unitOf(units, course.unit), name = unitName(unit);
  const { x, values } = useMemo(() => ({
    x: course.values.map((_, k) => (k + 0.5) * course.step),
    values: [course.values.map((value) => (value === null ? null : value * unit.factor + unit.offset))],
  }), [course, unit.factor, unit.offset]);
  const title = say("ownCourse", { stroke: course.stroke });
  return (
    <div data-course={course.stroke}>
      <Plot label={`${title}: ${expression}`} x={x} values={values} lines={[{ label: title, color: pageColor("--line-a") }]} xLabel={`${say("time")} (s)`} yLabel={name} height={180} />
    </div>
  );
}
