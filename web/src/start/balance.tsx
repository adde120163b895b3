import { useEffect, useRef } from "preact/hooks";
import { Formula } from "../formula";
import { TermPlot, useLaw } from "../law";
import { Told } from "../told";
import { useTyped } from "../typed";
import type { Balance, LogPicture, Proposal, WrittenEffect } from "../types";
import { useWords } from "../words";
import { saidUnits } from "./gate_thresholds";
import { ownTyped } from "./proposal";

const pause = 300;  // ms without a key after which what was written is looked at

/** What is written of a machine of one's own. */
export interface Written { balance: Balance; effects: WrittenEffect[] }

export function BalanceFormula({ balance }: { balance: Balance }) {
  const whole = balance.output.trim() !== "" && balance.terms.length > 0 && balance.terms.every((term) => term.name !== "" && term.expression.trim() !== "");
  const product = (name: string, factor: string) => (factor === "1" ? name : /^\w+$/.test(factor) ? `${name} ${factor}` : `${name} (${factor})`);
  return whole ? <p><Formula law={`${balance.output} = ${balance.terms.map((term) => product(term.name, term.expression.trim())).join(" + ")}`} /></p> : null;
}

const free = (known: string[], name: string) => { for (let n = 1; ; ++n) if (!known.includes(`${name}_${n}`)) return `${name}_${n}`; };

interface FieldProps { name: string; label: string; expression: string; write: (text: string) => void; checked: boolean; over: unknown; plotted: string; output?: string }

/** An expression with what is wrong with it, and its course over a stroke. */
function ExpressionField({ name, label, expression, write, checked, over, plotted, output }: FieldProps) {
  const { problem, course } = useLaw({ id: "term", expression: checked ? expression : "", not_negative: false, output }, over);
  const wrong = problem === "none" ? null : problem;
  return (
    <>
      <input name={name} class="code expression" aria-label={label} value={expression} spellcheck={false} autocomplete="off" aria-invalid={wrong ? "true" : undefined}
        onInput={(e) => write(e.currentTarget.value)} />
      {(wrong || course) && <div class="law">
        {wrong && <pre class="problem" role="status"><Told of={wrong} what="error" /></pre>}
        {course && <TermPlot course={course} expression={expression} units={saidUnits} title={plotted} height={120} />}
      </div>}
    </>
  );
}

/** Without lines that nothing was written into yet. */
const filled = ({ balance: { output, terms }, effects }: Written): Written =>
  ({ balance: { output, terms: terms.filter((term) => term.expression.trim() !== "") }, effects: effects.filter((effect) => effect.expression.trim() !== "") });
/** Whether it can be looked at. */
const isWhole = ({ balance: { output, terms }, effects }: Written) =>
  output.trim() !== "" && terms.length > 0 && terms.every((term) => term.name !== "") && effects.every((effect) => effect.id !== "");

/** `write`: something is being written, which is whole or not; `set`: what was written, once no key is pressed. */
interface Props { proposal: Proposal | null; picture: LogPicture | null; write: (whole: boolean) => void; set: (written: Written) => void }

/** Balance and effects of a machine of one's own; without a proposal nothing that is written can be looked at yet. */
export function BalanceEditor({ proposal, picture, write, set }: Props) {
  const say = useWords();
  const balance = proposal?.balance;
  const first: Written = { balance: balance && balance.terms.length > 0 ? balance : { output: balance?.output ?? "", terms: [{ name: "k_1", expression: "" }] }, effects: proposal?.effects ?? [] };
  const [text, setText] = useTyped(ownTyped, JSON.stringify(first));
  const written = JSON.parse(text) as Written, { output, terms } = written.balance, { effects } = written;
  const touched = useRef(text !== JSON.stringify(first));
  useEffect(() => {
    if (!touched.current || !proposal) return;
    const lines = filled(written), whole = isWhole(lines);
    write(whole);
    if (!whole) return;
    const timer = setTimeout(() => set(lines), pause);
    return () => clearTimeout(timer);
  }, [text]);
  const change = (next: Partial<Written>) => { touched.current = true; setText(JSON.stringify({ ...written, ...next })); };
  const changeTerm = (index: number, part: Partial<Balance["terms"][number]>) =>
    change({ balance: { output, terms: terms.map((term, k) => (k === index ? { ...term, ...part } : term)) } });
  const changeEffect = (index: number, part: Partial<WrittenEffect>) => change({ effects: effects.map((effect, k) => (k === index ? { ...effect, ...part } : effect)) });
  const shared = { checked: proposal !== null, over: picture };
  const ofTerm = { ...shared, output: output.trim() };
  const stroke = say("ownOverStroke");
  return (
    <>
      <fieldset class="balance own">
        <legend>{say("balanceTitle")}</legend>
        <p>{say("balanceText")} <code>ddt(…)  sign(…)  abs(…)  sqrt(…)  exp(…)  max(…, …)</code></p>
        <div class="output"><span>{say("balanceOutput")}</span>
          <ExpressionField name="balance-output" label={say("balanceOutput")} expression={output} plotted={`${output}, ${stroke}`} {...shared}
            write={(next) => change({ balance: { output: next, terms } })} /></div>
        <ol class="terms">
          {terms.map((term, k) => (
            <li key={k}>
              <input name={`balance-name-${k}`} class="code" aria-label={`${say("parameter")} ${k + 1}`} value={term.name} spellcheck={false} autocomplete="off"
                onInput={(e) => changeTerm(k, { name: e.currentTarget.value.trim() })} />
              <span>×</span>
              <ExpressionField name={`balance-expression-${k}`} label={`${say("ownExpression")} ${k + 1}`} expression={term.expression} plotted={`${term.expression}, ${stroke}`} {...ofTerm}
                write={(expression) => changeTerm(k, { expression })} />
              <button class="small" aria-label={`${say("balanceDrop")}: ${term.name}`} disabled={terms.length < 2}
                onClick={() => change({ balance: { output, terms: terms.filter((_, other) => other !== k) } })}>×</button>
            </li>
          ))}
        </ol>
        <button class="small" onClick={() => change({ balance: { output, terms: [...terms, { name: free(terms.map((term) => term.name), "k"), expression: "" }] } })}>{say("balanceMore")}</button>
        <BalanceFormula balance={written.balance} />
      </fieldset>
      <fieldset class="balance own effects">
        <legend>{say("ownEffects")}</legend>
        <p>{say("ownEffectsText")}</p>
        <ol class="terms">
          {effects.map((effect, k) => (
            <li key={k}>
              <input name={`effect-id-${k}`} class="code" aria-label={`${say("ownName")} ${k + 1}`} value={effect.id} spellcheck={false} autocomplete="off"
                onInput={(e) => changeEffect(k, { id: e.currentTarget.value.trim() })} />
              <span>×</span>
              <ExpressionField name={`effect-expression-${k}`} label={`${say("rankingEffect")} ${k + 1}`} expression={effect.expression} plotted={`${effect.expression}, ${stroke}`} {...ofTerm}
                write={(expression) => changeEffect(k, { expression })} />
              <button class="small" aria-label={`${say("balanceDrop")}: ${effect.id}`} onClick={() => change({ effects: effects.filter((_, other) => other !== k) })}>×</button>
              <label class="tick-box"><input type="checkbox" checked={effect.not_negative} onChange={(e) => changeEffect(k, { not_negative: e.currentTarget.checked })} /> {say("ownNotNegative")}</label>
            </li>
          ))}
        </ol>
        <button class="small" onClick={() => change({ effects: [...effects, { id: free(effects.map((effect) => effect.id), "effect"), expression: "", not_negative: true }] })}>{say("ownEffectMore")}</button>
      </fieldset>
    </>
  );
}
