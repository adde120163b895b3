import { useEffect, useMemo, useState } from "preact/hooks";
import { find } from "../api";
import { failureOf, Problem, useAttempt, type Failure } from "../failure";
import { Formula } from "../formula";
import { withShares, work } from "../store";
import type { CompareResult, Effect, ExplainResult, Preview, Session } from "../types";
import { Told, ToldList, useTold } from "../told";
import { amount } from "../units";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import { OwnEffect } from "./own_effect";
import { ParameterTable } from "./parameter_table";
import { TitleOf } from "./parts";
import { Outputs, tellingStroke, usePicture } from "./stroke_overlay";

interface Props { id: string; session: Session; effects: Effect[]; explain?: ExplainResult; compare?: CompareResult }

/** What an effect would do to the error, and the button that adds it. */
export function AddEffect({ id, session, effects, explain, compare }: Props) {
  const say = useWords(), tell = useTold();
  const [, setUrl] = useUrl();
  const machine = session.machine!;
  const effect = effects.find((known) => known.id === id);
  const part = machine.effects.includes(id);
  const testable = explain?.ranking.find((ranked) => ranked.effect === id)?.testable ?? true;
  const { preview, problem } = usePreview(id, machine.version, !part && effect !== undefined && testable);
  const { busy, problem: failure, attempt } = useAttempt();
  const change = (kind: "add" | "remove") => attempt(async () => {
    await work(kind, { effect: id });
    setUrl({ step: "confirm", effect: "" });
  });
  const choose = (effect: string) => setUrl({ effect });
  const others = <><PartList session={session} effects={effects} choose={choose} /><OwnEffect machine={machine} units={session.units} choose={choose} /></>;
  if (!effect) return <><h1>{say("addTitle")}</h1><p class="empty">{say("addChoose")}</p>{others}</>;
  const title = tell(effect, "title").text || effect.id;
  return (
    <>
      <h1>{say("addTitle")}</h1>
      <h2><Told of={effect} what="title" /></h2>
      {effect.plain && <p><Told of={effect} what="plain" /></p>}
      <dl class="facts">
        <div><dt>{say("addLaw")}</dt><dd><Formula law={effect.law} /></dd></div>
        {effect.source && <div><dt>{say("addSource")}</dt><dd lang="en">{effect.source}</dd></div>}
        {effect.hidden_in && <div><dt>{say("addHides")}</dt><dd>{effect.hidden_in}</dd></div>}
        {effect.told_apart_by && <div><dt>{say("addTold")}</dt><dd><Told of={effect} what="told_apart_by" /></dd></div>}
      </dl>
      {part ? <>
        <p>{say("addPart")}</p>
        <button disabled={busy} onClick={() => void change("remove")}>{say("removeButton", { title })}</button>
      </> : <>
        {!preview && !problem && testable && <p class="empty" role="status">{say("addWorking")}</p>}
        <Problem of={problem} />
        {preview && <Effects preview={preview} />}
        {preview && compare && explain && <OverAStroke id={id} title={title} session={session} compare={compare} />}
        <button class="primary" data-add={id} disabled={busy || !preview} onClick={() => void change("add")}>{say("addButton", { title })}</button>
      </>}
      <Problem of={failure} />
      {others}
    </>
  );
}

function PartList({ session, effects, choose }: { session: Session; effects: Effect[]; choose: (effect: string) => void }) {
  const say = useWords();
  const parts = session.machine!.effects;
  if (parts.length === 0) return null;
  return <p class="quiet">{say("addPart")} {parts.map((id) => <button key={id} class="link" onClick={() => choose(id)}><TitleOf id={id} effects={effects} /></button>)}</p>;
}

function Effects({ preview }: { preview: Preview }) {
  const say = useWords();
  const error = preview.error;
  const most = error ? Math.max(error.before, error.after, error.noise_floor) : 1;
  return (
    <div class="preview">
      {error && <>
        <p><strong data-preview={error.after}>{say("addPreview")} {amount(error.after, error.unit)}</strong></p>
        <ul class="bars">
          {([["now", error.before, "old"], ["withIt", error.after, "new"], ["noise", error.noise_floor, "floor"]] as const).map(([word, value, kind]) => (
            <li key={word}><span>{say(word)}</span><span class="bar"><i class={kind} style={{ width: `${(100 * value) / most}%` }} /></span><span class="num">{amount(value, error.unit)}</span></li>
          ))}
        </ul>
      </>}
      {preview.held_out && <p>{say("addHeldOut", { log: preview.held_out.log.split("/").pop()!, before: amount(preview.held_out.before, preview.held_out.unit), after: amount(preview.held_out.after, preview.held_out.unit) })}</p>}
      {preview.warnings.length > 0 && <div class="verdict bad"><strong>{say("addAgainst")}</strong><ul><ToldList of={preview.warnings} german={preview.german?.warnings} /></ul></div>}
      <ParameterTable left={preview.parameters_before} right={preview.parameters_after} names={[say("now"), say("withIt")]} />
    </div>
  );
}

/** A stroke as the model has it, and as it would with the effect. */
function OverAStroke({ id, title, session, compare }: { id: string; title: string; session: Session; compare: CompareResult }) {
  const say = useWords(), tell = useTold();
  const machine = session.machine!;
  const stroke = useMemo(() => tellingStroke(compare), [compare]);
  const picture = usePicture(stroke, machine.version, compare, id);
  const withIt = useMemo(() => (picture?.with_effect ? { ...picture, modelled: picture.with_effect } : null), [picture]);
  if (!picture || !withIt) return null;
  return (
    <section class="over-a-stroke" data-over={id}>
      <h3>{say("addOverStroke", { stroke: picture.stroke })}</h3>
      <Outputs picture={withIt} before={picture} parent={machine.version} region={[]} output={tell(machine, "output").text} modelled={`+ ${title}`} choose={() => {}} />
    </section>
  );
}

interface Previewed { preview: Preview | null; problem: Failure | null }
const notPreviewed: Previewed = { preview: null, problem: null };

function usePreview(effect: string, version: number, wanted: boolean): Previewed {
  const [state, setState] = useState(notPreviewed);
  useEffect(() => {
    setState(notPreviewed);
    if (!wanted) return;
    let current = true;
    const show = (next: Previewed) => current && setState(next);
    const query = { kind: "preview", about: effect, version };
    const load = async () => {
      let preview = await find<Preview>("results", query);
      if (!preview) {
        await work("preview", { effect });
        preview = await find<Preview>("results", query);
      }
      withShares(preview?.error);
      show({ preview, problem: null });
    };
    load().catch((caught) => show({ preview: null, problem: failureOf(caught) }));
    return () => { current = false; };
  }, [effect, version, wanted]);
  return state;
}
