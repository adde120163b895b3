import { useState } from "preact/hooks";
import { post } from "../api";
import { Problem, useAttempt } from "../failure";
import { refresh } from "../store";
import { useTold } from "../told";
import type { Effect, Session } from "../types";
import { short, unitName, unitOf, withUnit } from "../units";
import { useWords } from "../words";
import { TitleOf } from "./parts";

const numberIn = (text: string) => (text.trim() === "" ? NaN : Number(text.replace(",", ".")));

/** What tests off the log said of effects: `explain` takes it for known. `suspects` are offered first. */
export function Measured({ session, effects, suspects }: { session: Session; effects: Effect[]; suspects: string[] }) {
  const say = useWords(), tell = useTold();
  const first = suspects.find((id) => effects.some((effect) => effect.id === id && effect.measured_by));
  const testable = effects.filter((effect) => effect.measured_by);
  const [chosen, setChosen] = useState(""), [size, setSize] = useState(""), [std, setStd] = useState("");
  const { busy, problem, attempt } = useAttempt();
  const effect = testable.find((e) => e.id === (chosen || first)) ?? testable[0];
  if (!effect || session.machine?.states || !session.changes) return null;
  const unit = unitOf(session.units, effect.unit), values = [numberIn(size), numberIn(std)];
  const put = (body: object) => void attempt(async () => { await post("measured", body); await refresh(); });
  return (
    <details class="measured" open={session.measured.length > 0}>
      <summary>{say("measuredTitle")}</summary>
      <ul>{session.measured.map((known) => {
        const of = effects.find((e) => e.id === known.effect), shown = unitOf(session.units, of?.unit ?? "1");
        return (
          <li key={known.effect}><TitleOf id={known.effect} effects={effects} />: {withUnit(`${short(known.size * shown.factor)} ± ${short(known.std * shown.factor)}`, unitName(shown))}{" "}
            <button class="quiet small" disabled={busy} onClick={() => put({ effect: known.effect })}>{say("measuredForget")}</button></li>);
      })}</ul>
      <label>{say("measuredEffect")} <select name="measured-effect" value={effect.id} onChange={(e) => setChosen(e.currentTarget.value)}>
        {testable.map((e) => <option key={e.id} value={e.id}>{tell(e, "title").text}</option>)}
      </select></label>
      <p class="quiet">{say("measuredBy")} <span lang={tell(effect, "measured_by").lang}>{tell(effect, "measured_by").text}</span></p>
      <div class="filters">
        <label>{say("measuredSize")} ({unitName(unit)}) <input name="measured-size" inputMode="decimal" value={size} onInput={(e) => setSize(e.currentTarget.value)} /></label>
        <label>± {say("measuredStd")} <input name="measured-std" inputMode="decimal" value={std} onInput={(e) => setStd(e.currentTarget.value)} /></label>
        <button disabled={busy || !values.every(Number.isFinite)} onClick={() => put({ effect: effect.id, size: values[0] / unit.factor, std: values[1] / unit.factor })}>{say("measuredTake")}</button>
      </div>
      <Problem of={problem} />
    </details>
  );
}
