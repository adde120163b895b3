import type { ComponentChild } from "preact";
import { useState } from "preact/hooks";
import type { Effect, ExplainResult, Parameter, Ranked, RegionErrors } from "../types";
import { Told } from "../told";
import { full, nameOf, shownNumber, type Units, withInterval } from "../units";
import { useWords } from "../words";
import { Scroll, TitleOf } from "./parts";

const shownAtFirst = 7;

/** `errors`: of a region that was chosen, by which the effects are ranked then. */
interface Props { explain: ExplainResult; errors: RegionErrors | null; effects: Effect[]; units: Units; chosen: string; choose: (effect: string) => void }

/** Every effect of the library, best first, and those that these strokes cannot test. */
export function Ranking({ explain, errors, effects, units, chosen, choose }: Props) {
  const say = useWords();
  const [all, setAll] = useState(false);
  const there = errors && errors.effects.length > 0 ? errors : null;
  const fitted = explain.ranking.filter((ranked) => ranked.testable && ranked.rms_holdout !== null);
  const tried = there ? there.effects.flatMap(({ effect, rms }) => fitted.filter((ranked) => ranked.effect === effect).map((ranked) => ({ ...ranked, rms_holdout: rms }))) : fitted;
  const before = there ? there.rms : explain.base.rms_holdout, noise = there ? there.noise : explain.noise_floor;
  const ruledOut = explain.ranking.filter((ranked) => ranked.testable && ranked.rms_holdout === null);
  const sized = tried.some((ranked) => Object.keys(ranked.parameters).length > 0);
  const untestable = explain.ranking.filter((ranked) => !ranked.testable);
  const title = (id: string) => <TitleOf id={id} effects={effects} />;
  return (
    <section class="ranking">
      <h2>{say("rankingTitle")}</h2>
      {there && <p class="region" data-ranked-there>{say("rankingThere")}</p>}
      {tried.length === 0 ? <p class="empty">{say("rankingNone")}</p> : (
        <Scroll label={say("rankingTitle")}>
          <table role="table">
            <thead><tr role="row"><th role="columnheader"><span class="unseen">{say("rankingEffect")}</span></th><th role="columnheader">{say(there ? "rankingErrorThere" : "rankingError")}{nameOf(explain.unit) && ` (${nameOf(explain.unit)})`}</th>{sized && <th role="columnheader">{say("rankingSize")}</th>}</tr></thead>
            <tbody>
              {tried.slice(0, all ? undefined : shownAtFirst).map((ranked) => (
                <tr key={ranked.effect} role="row" class={ranked.effect === chosen ? "chosen" : ""}>
                  <th scope="row" role="rowheader"><button class="link" onClick={() => choose(ranked.effect)}>{title(ranked.effect)}{ranked.significant && "\u00a0*"}</button></th>
                  <td role="cell">{ranked.fitted === false && "~"}{full(shownNumber(ranked.rms_holdout, explain.unit))}<Bar share={ranked.rms_holdout! / Math.max(before, noise)} /></td>
                  {sized && <td role="cell">{sizes(ranked, effects.find((effect) => effect.id === ranked.effect)).map(([name, parameter]) => <div key={name}><small>{name}</small> {withInterval(parameter, units)}</div>)}</td>}
                </tr>
              ))}
            </tbody>
          </table>
        </Scroll>
      )}
      {tried.some((ranked) => ranked.significant) && <p class="quiet">* {say("rankingStands")}</p>}
      {tried.some((ranked) => ranked.fitted === false) && <p class="quiet">~ {say("rankingLinear")}</p>}
      {tried.length > shownAtFirst && !all && <button class="quiet" onClick={() => setAll(true)}>{say("rankingMore", { count: tried.length })}</button>}
      {untestable.length > 0 && <Excluded title={`${say("untestable")} (${untestable.length})`} text={say("untestableText")} list={untestable} name={title} />}
      {ruledOut.length > 0 && <Excluded title={`${say("ruledOut")} (${ruledOut.length})`} text="" list={ruledOut} name={title} />}
    </section>
  );
}

/** The size first, then what else was found; a number in the size's own unit is the size once more. */
function sizes(ranked: Ranked, effect?: Effect): [string, Parameter][] {
  const size = effect && ranked.parameters[effect.parameter];
  if (!size) return Object.entries(ranked.parameters);
  const others = Object.entries(ranked.parameters).filter(([name, other]) => name !== effect.parameter && other.unit !== size.unit);
  return [[effect.parameter, size], ...others];
}

/** The error as a length, of that of the model as it is. */
function Bar({ share }: { share: number }) {
  return <span class="mini" aria-hidden="true"><i style={{ width: `${100 * Math.max(0, Math.min(1, share))}%` }} /></span>;
}

function Excluded({ title, text, list, name }: { title: string; text: string; list: Ranked[]; name: (id: string) => ComponentChild }) {
  return (
    <details class="untestable"><summary>{title}</summary>
      {text && <p class="quiet">{text}</p>}
      <dl>{list.map((ranked) => <div key={ranked.effect}><dt>{name(ranked.effect)}</dt><dd>{ranked.why_not && <Told of={{ why_not: ranked.why_not, german: ranked.german }} what="why_not" />}</dd></div>)}</dl>
    </details>
  );
}
