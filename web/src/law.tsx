// An expression over the signals while it is being written: what is wrong with it, and its course over a stroke.

import { useEffect, useMemo, useState } from "preact/hooks";
import { post } from "./api";
import { failureOf, type Failure } from "./failure";
import { pageColor, Plot } from "./plot";
import { unitName, unitOf, type Units } from "./units";
import { useWords } from "./words";

const pause = 250;  // ms without a key after which what was written is looked at

/** The term over a stroke, SI; null between stretches of it. */
export interface Course { stroke: number; step: number; values: (number | null)[]; unit: string }

/** Looks at an expression, again when `over` changes. `problem`: "none", or null where nothing is written. */
export function useLaw(written: { id: string; expression: string; not_negative: boolean; output?: string }, over: unknown = null) {
  const [problem, setProblem] = useState<Failure | "none" | null>(null);
  const [course, setCourse] = useState<Course | null>(null);
  useEffect(() => {
    if (written.expression.trim() === "") { setCourse(null); return setProblem(null); }
    let wanted = true;
    const says = (wrong: Failure | "none", there: Course | null) => { if (wanted) { setProblem(wrong); setCourse(there); } };
    const timer = setTimeout(() => {
      post<{ course: Course | null }>("effect", written).then((answer) => says("none", answer.course), (caught) => says(failureOf(caught), null));
    }, pause);
    return () => { wanted = false; clearTimeout(timer); };
  }, [written.id, written.expression, written.not_negative, written.output, over]);
  return { problem, course, setProblem };
}

/** What the expression gives over the stroke that the model errs most on, while it is being written. */
export function TermPlot({ course, expression, units, title: called, height = 180 }: { course: Course; expression: string; units: Units; title?: string; height?: number }) {
  const say = useWords();
  const unit = unitOf(units, course.unit), name = unitName(unit);
  const { x, values } = useMemo(() => ({
    x: course.values.map((_, k) => (k + 0.5) * course.step),
    values: [course.values.map((value) => (value === null ? null : value * unit.factor + unit.offset))],
  }), [course, unit.factor, unit.offset]);
  const title = called ?? say("ownCourse", { stroke: course.stroke });
  return (
    <div data-course={course.stroke}>
      <Plot label={`${title}: ${expression}`} x={x} values={values} lines={[{ label: title, color: pageColor("--line-a") }]} xLabel={`${say("time")} (s)`} yLabel={name} height={height} />
    </div>
  );
}
