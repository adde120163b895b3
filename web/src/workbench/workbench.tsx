import { Problem } from "../failure";
import { ofLoop, useStore } from "../store";
import type { Session } from "../types";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import { AddEffect } from "./add_effect";
import { Check } from "./check";
import { Compare } from "./compare";
import { Confirm, Save } from "./confirm";
import { Logs } from "./logs";
import { Locate } from "./locate";
import { LoopCompare, LoopLocate, LoopParameters, LoopVerdict } from "./loop";
import { Promote } from "./promote";
import { Ranking } from "./ranking";
import { useRegionErrors } from "./region";
import { Staircase } from "./staircase";
import { ValveLocate, ValveParameters, ValveResponse, ValveVerdict, useValve, type Measured } from "./valve_response";
import { Verdict } from "./verdict";

export const steps = ["check", "compare", "locate", "add", "confirm", "promote"] as const;
export type Step = (typeof steps)[number];

function Stepper({ step, go }: { step: Step; go: (step: Step) => void }) {
  const say = useWords();
  return (
    <nav class="stepper" aria-label={say("steps")}>
      <ol>
        {steps.map((name, index) => (
          <li key={name}><button aria-current={name === step ? "step" : undefined} onClick={() => go(name)}><span>{index + 1}</span>{say(`step_${name}`)}</button></li>
        ))}
      </ol>
    </nav>
  );
}

/** The steps of a machine in closed loop that are others: nothing is added to its model, it is measured anew. */
function LoopStep({ step, session }: { step: Step; session: Session }) {
  const say = useWords();
  const { results } = useStore(), { response, changes } = ofLoop(results);
  if (step === "compare") return <LoopCompare result={response} changes={changes} session={session} />;
  if (step === "locate") return <LoopLocate result={response} />;
  return (
    <>
      <h1>{say(step === "add" ? "addTitle" : "confirmTitle")}</h1>
      <p>{say(step === "add" ? "loopAdd" : "loopConfirm")}</p>
      {step === "confirm" && <><LoopParameters result={response} changes={changes} session={session} /><Save session={session} /></>}
    </>
  );
}

/** The same of a valve alone. */
function ValveStep({ step, session, measured, query, setUrl }: { step: Step; session: Session; measured: Measured; query: Record<string, string>; setUrl: (change: Record<string, string>) => void }) {
  const say = useWords();
  if (step === "compare") return <ValveResponse measured={measured} query={query} setUrl={setUrl} />;
  if (step === "locate") return <ValveLocate measured={measured} />;
  return (
    <>
      <h1>{say(step === "add" ? "addTitle" : "confirmTitle")}</h1>
      <p>{say(step === "add" ? "valveAdd" : "valveConfirm")}</p>
      {step === "confirm" && <>{measured.result && <ValveParameters result={measured.result} />}<Save session={session} /></>}
    </>
  );
}

/** One screen: versions on the left, the step in the middle, the verdict on the right. */
export function Workbench({ session }: { session: Session }) {
  const say = useWords();
  const [query, setUrl] = useUrl();
  const { results, failed, effects } = useStore();
  const step = steps.find((name) => name === query.step) ?? "compare", loop = session.machine!.closed_loop;
  const choose = (effect: string) => setUrl({ effect, step: "add" });
  const kind = step === "check" ? "check" : step === "add" && !session.machine!.closed_loop ? "explain" : "compare";
  const alone = session.machine!.valve_alone, onValve = alone || (session.machine!.valve && step === "compare" && query.drawn === "valve");
  const problem = alone && step !== "check" ? undefined : failed[kind];
  const measured = useValve(onValve, session, query);
  const errors = useRegionErrors(query.region, session.machine!.version, `${results.compare !== undefined} ${results.explain !== undefined}`);
  return (
    <div class="workbench">
      <Stepper step={step} go={(name) => setUrl({ step: name })} />
      <aside class="left">{!loop && !alone && <Staircase session={session} />}<Logs session={session} /></aside>
      <section class="centre" aria-live="polite">
        {onValve && !alone ? <>
            <button class="quiet" onClick={() => setUrl({ drawn: "" })}>‹ {say("valveBack")}</button>
            <ValveResponse measured={measured} query={query} setUrl={setUrl} />
          </>
          : problem ? <><Problem of={problem} before={say("failed")} />{session.machine!.valve && step === "compare" && <p>{say("valveInstead")} <button onClick={() => setUrl({ drawn: "valve" })}>{say("valveTab")}</button></p>}</>
          : step === "check" ? <Check check={results.check} picture={results.picture} session={session} />
          : alone && step !== "promote" ? <ValveStep {...{ step, session, measured, query, setUrl }} />
          : loop && step !== "promote" ? <LoopStep step={step} session={session} />
          : step === "compare" ? <Compare compare={results.compare} errors={errors} session={session} query={query} setUrl={setUrl} />
          : step === "locate" ? <Locate compare={results.compare} errors={errors} query={query} setUrl={setUrl} />
          : step === "add" ? <AddEffect id={query.effect ?? results.explain?.set[0] ?? ""} session={session} effects={effects} explain={results.explain} compare={results.compare} />
          : step === "confirm" ? <Confirm compare={results.compare} session={session} query={query} setUrl={setUrl} />
          : <Promote session={session} />}
      </section>
      <aside class="right">
        {onValve ? <ValveVerdict measured={measured} />
          : loop ? <LoopVerdict changes={ofLoop(results).changes} problem={failed.explain} session={session} />
          : <Verdict explain={results.explain} effects={effects} session={session} problem={failed.explain} choose={choose} />}
        {!loop && !onValve && results.explain && <Ranking explain={results.explain} errors={errors} effects={effects} units={session.units} chosen={query.effect ?? ""} choose={choose} />}
      </aside>
    </div>
  );
}
