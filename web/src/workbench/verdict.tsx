import { Problem, type Failure } from "../failure";
import { Formula } from "../formula";
import type { Effect, ExplainResult, ProposedLaw, Session } from "../types";
import { Told, ToldList } from "../told";
import { type } from "../typed";
import { amount } from "../units";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import type { Words } from "../words/en";
import { Experiment } from "./experiment";
import { Measured } from "./measured";
import { AsPrinted, TitleOf } from "./parts";
import { useRangeWords } from "./region";
import { Remainder } from "./remainder";
import { Swap } from "./swap";

interface Props { explain?: ExplainResult; effects: Effect[]; session: Session; problem?: Failure; choose: (effect: string) => void }

const oddOf = (explain: ExplainResult) => (explain.odd_strokes ?? []).reduce((sum, odd) => sum + odd.strokes.length, 0);

const notProven = (explain: ExplainResult) => explain.set.length > 0 && (explain.partial || !!explain.doubt);

/** An effect of the model that another one explains better comes before what would be missing beside it. */
const swapLeads = (explain: ExplainResult) => !!explain.swap?.explains && explain.verdict !== "adequate";

/** An adequate model may be so in part only, and of an unknown error it may be open whether it is one. */
function headline(explain: ExplainResult): keyof Words {
  if (swapLeads(explain)) return explain.swap!.proven ? "swapFirst" : "swapFirstInDoubt";
  if (explain.may_be_noise) return "mayBeNoise";
  if (explain.small_error) return "smallError";
  if (explain.slow) return "slow";
  if (explain.verdict === "adequate" && explain.short_runs) return "shortRuns";
  if (explain.verdict === "unknown" && explain.astray) return "astray";
  if (explain.verdict === "unknown" && explain.doubtful) return "doubtful";
  if (explain.only_zeros) return "onlyZeros";
  if (explain.verdict === "adequate" && oddOf(explain) > 0) return "adequateSome";
  if (notProven(explain) && explain.verdict === "named") return "namedInDoubt";
  if (notProven(explain) && explain.verdict === "ambiguous") return "ambiguousInDoubt";
  return explain.verdict;
}

/** What the model misses, in plain words, and what to do about it. */
export function Verdict({ explain, effects, session, problem, choose }: Props) {
  const say = useWords(), rangeWords = useRangeWords();
  if (problem) return <section class="verdict-panel"><h2>{say("verdictTitle")}</h2><Problem of={problem} before={say("failed")} /></section>;
  if (!explain) return <section class="verdict-panel"><h2>{say("verdictTitle")}</h2><p class="empty">{say("verdictComing")}</p></section>;
  const unit = explain.unit;
  const errors = { before: amount(explain.base.rms_holdout, unit), after: amount(explain.final.rms_holdout, unit), noise: say(explain.noise_at_most ? "noiseAtMost" : "noiseAlone", { noise: amount(explain.noise_floor, unit) }) };
  return (
    <section class={`verdict-panel ${explain.verdict}`}>
      <h2>{say("verdictTitle")}</h2>
      <p class="headline" data-verdict={explain.verdict}>{say(headline(explain), { described: explain.strokes - oddOf(explain), count: explain.strokes })}</p>
      {!swapLeads(explain) && explain.set.map((id) => <Suspect key={id} id={id} effect={effects.find((e) => e.id === id)} choose={choose} />)}
      {explain.verdict === "unknown" && explain.located?.[0] && <p><strong>{rangeWords(explain.located[0], explain.located[0].unit)}</strong></p>}
      {explain.verdict === "unknown" && (explain.nearest?.length ?? 0) > 0 && <p>{say("nearest")}{explain.nearest!.map((id, at) => <>{at > 0 && ", "}<TitleOf id={id} effects={effects} /></>)}</p>}
      {explain.doubt && <p>{say(explain.set.length > 0 || explain.partial ? "notProven" : "whyUnknown")}<Told of={{ text: explain.doubt, german: { text: explain.german?.doubt } }} what="text" /></p>}
      {explain.relatives?.map((relative) => <p key={relative.effect}><Told of={relative} what="sentence" /></p>)}
      {(explain.proposed_laws?.length ?? 0) > 0 && <Proposed laws={explain.proposed_laws!} unit={unit} />}
      <p>{say(explain.set.length > 0 ? "verdictErrors" : "verdictError", errors)}{explain.short_runs && ` ${say("verdictShort")}`}</p>
      {Object.entries(explain.final.drifts ?? {}).map(([id, text]) => <p key={id}>{say("drift", { text: "" })}<Told of={{ text, german: { text: explain.final.german?.drifts[id] } }} what="text" /></p>)}
      {explain.odd_strokes?.map((odd) => <p key={odd.strokes.join()}>{say("notEverywhere")}<Told of={odd} what="sentence" /></p>)}
      {explain.swap && <Swap swap={explain.swap} unit={unit} effects={effects} />}
      {explain.warnings.length > 0 && <details open={explain.slow || explain.verdict === "unknown"}><summary>{say("warnings")}</summary><ul><ToldList of={explain.warnings} german={explain.german?.warnings} /></ul></details>}
      {explain.remainder && <Remainder remainder={explain.remainder} unit={unit} />}
      <Experiment explain={explain} units={session.units} />
      <Measured session={session} effects={effects} suspects={explain.set} />
      <AsPrinted text={explain.text} />
    </section>
  );
}

/** Laws that may be missing in the machine file; each leads to where it is written as an effect. */
function Proposed({ laws, unit }: { laws: ProposedLaw[]; unit: string }) {
  const say = useWords();
  const [, go] = useUrl();
  const write = (expression: string) => { type("own expression", expression); go({ step: "add", effect: "" }); };
  return (
    <div class="proposed">
      <p>{say("mayGoWith")}</p>
      {laws.map((law) => (
        <div class="suspect" key={law.expression}>
          <p><Formula law={`k ${law.expression}`} /> {amount(law.rms_holdout, unit)}</p>
          {law.late_signal ? <p><Told of={law} what="sentence" /></p>
            : <button data-law={law.expression} onClick={() => write(law.expression)}>{say("writeAsEffect")}</button>}
        </div>
      ))}
    </div>
  );
}

function Suspect({ id, effect, choose }: { id: string; effect?: Effect; choose: (effect: string) => void }) {
  const say = useWords();
  return (
    <div class="suspect">
      <button class="primary" data-effect={id} onClick={() => choose(id)}><TitleOf id={id} effects={effect ? [effect] : []} /></button>
      {effect && <>
        <p><Formula law={effect.law} /></p>
        {effect.plain && <><h3>{say("inspect")}</h3><p><Told of={effect} what="plain" /></p></>}
      </>}
    </div>
  );
}
