import { useEffect, useRef, useState } from "preact/hooks";
import type { Failure } from "../failure";
import { Formula } from "../formula";
import { Told } from "../told";
import type { Balance } from "../types";
import { useWords } from "../words";

const pause = 300;  // ms without a key after which what was written is looked at

const same = (one: Balance, other: Balance) => one.output === other.output && one.terms.length === other.terms.length
  && one.terms.every((term, k) => term.name === other.terms[k].name && term.expression === other.terms[k].expression);

/** The balance of a machine of one's own: which output is the sum of which terms. */
export function BalanceEditor({ proposed, signals, problem, set }: { proposed: Balance; signals: string[]; problem: Failure | null; set: (balance: Balance) => void }) {
  const say = useWords();
  const [balance, setBalance] = useState<Balance>(proposed.terms.length > 0 ? proposed : { output: proposed.output, terms: [{ name: "k_1", expression: "" }] });
  const touched = useRef(false);
  const whole = balance.output !== "" && balance.terms.length > 0 && balance.terms.every((term) => term.name !== "" && term.expression.trim() !== "");
  useEffect(() => {
    if (!touched.current || !whole) return;
    const timer = setTimeout(() => set(balance), pause);
    return () => clearTimeout(timer);
  }, [balance]);
  const looked = same(proposed, balance);  // the problem is of what stands here
  const change = (next: Balance) => { touched.current = true; setBalance(next); };
  const changeTerm = (index: number, part: Partial<Balance["terms"][number]>) =>
    change({ ...balance, terms: balance.terms.map((term, k) => (k === index ? { ...term, ...part } : term)) });
  const free = () => { for (let n = balance.terms.length + 1; ; ++n) if (!balance.terms.some((term) => term.name === `k_${n}`)) return `k_${n}`; };
  return (
    <fieldset class="balance own">
      <legend>{say("balanceTitle")}</legend>
      <p>{say("balanceText")} <code>{signals.join("  ")}  ddt(…)  sign(…)  sqrt(…)  exp(…)  max(…, …)</code></p>
      <label>{say("balanceOutput")} <input name="balance-output" class="code" list="balance-signals" spellcheck={false} autocomplete="off" value={balance.output}
        onInput={(e) => change({ ...balance, output: e.currentTarget.value })} /></label>
      <datalist id="balance-signals">{signals.map((signal) => <option key={signal} value={signal} />)}</datalist>
      <ol class="terms">
        {balance.terms.map((term, k) => (
          <li key={k}>
            <input name={`balance-name-${k}`} class="code" aria-label={`${say("parameter")} ${k + 1}`} value={term.name} spellcheck={false} autocomplete="off"
              onInput={(e) => changeTerm(k, { name: e.currentTarget.value.trim() })} />
            <span>×</span>
            <input name={`balance-expression-${k}`} class="code" aria-label={`${say("ownExpression")} ${k + 1}`} value={term.expression} spellcheck={false} autocomplete="off"
              onInput={(e) => changeTerm(k, { expression: e.currentTarget.value })} />
            <button class="small" aria-label={`${say("balanceDrop")}: ${term.name}`} disabled={balance.terms.length < 2}
              onClick={() => change({ ...balance, terms: balance.terms.filter((_, other) => other !== k) })}>×</button>
          </li>
        ))}
      </ol>
      <button class="small" onClick={() => change({ ...balance, terms: [...balance.terms, { name: free(), expression: "" }] })}>{say("balanceMore")}</button>
      {whole && <p><Formula law={`${balance.output} = ${balance.terms.map((term) => `${term.name} (${term.expression})`).join(" + ")}`} /></p>}
      {problem && whole && looked && <pre class="problem" role="status"><Told of={problem} what="error" /></pre>}
    </fieldset>
  );
}
