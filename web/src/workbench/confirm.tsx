import { useState } from "preact/hooks";
import { post } from "../api";
import { Problem, useAttempt } from "../failure";
import { refresh } from "../store";
import type { CompareResult, Session, Version } from "../types";
import { amount } from "../units";
import { useTold } from "../told";
import { useWords } from "../words";
import { ParameterTable } from "./parameter_table";
import { useModelName } from "./parts";
import { Outputs, tellingStroke, usePicture } from "./stroke_overlay";

interface Props { compare?: CompareResult; session: Session; query: Record<string, string>; setUrl: (change: Record<string, string>) => void }

/** Whether adding helped, and saving it. */
export function Confirm({ compare, session, query, setUrl }: Props) {
  const say = useWords(), modelName = useModelName();
  const current = session.versions.find((version) => version.current);
  const before = session.versions.find((version) => version.version === current?.parent);
  const left = session.versions.find((version) => String(version.version) === query.left) ?? before ?? session.versions[0];
  const right = session.versions.find((version) => String(version.version) === query.right) ?? current;
  const name = (version: Version) => `${version.version}: ${modelName(version.effects)}`;
  return (
    <>
      <h1>{say("confirmTitle")}</h1>
      {before && current && before.rms_holdout !== null && current.rms_holdout !== null
        ? <p class={current.rms_holdout < before.rms_holdout ? "verdict good" : "verdict bad"} data-error={current.rms_holdout} role="status">
            {say(current.rms_holdout < before.rms_holdout ? "confirmText" : "confirmRose", { before: amount(before.rms_holdout, current.unit ?? ""), after: amount(current.rms_holdout, current.unit ?? ""), noise: amount(current.noise_floor, current.unit ?? "") })}</p>
        : <p class="empty">{say("confirmNothing")} <button onClick={() => setUrl({ step: "add" })}>{say("addTitle")}</button></p>}
      {left && right && session.versions.length > 1 && <>
        <h2>{say("confirmTwo")}</h2>
        <div class="pair">
          {([["left", left], ["right", right]] as const).map(([side, chosen]) => (
            <select key={side} aria-label={`${say("confirmVersion")} ${side === "left" ? 1 : 2}`} value={chosen.version} onChange={(e) => setUrl({ [side]: e.currentTarget.value })}>
              {session.versions.map((version) => <option key={version.version} value={version.version}>{name(version)}</option>)}
            </select>
          ))}
        </div>
        <ParameterTable left={left.parameters} right={right.parameters} names={[name(left), name(right)]} />
        {compare && left !== right && <StrokePair compare={compare} left={left} right={right} session={session} query={query} setUrl={setUrl} />}
      </>}
      <Save session={session} />
    </>
  );
}

/** A stroke as both versions have it: what they predict, and what each leaves. */
function StrokePair({ compare, left, right, session, query, setUrl }: Props & { compare: CompareResult; left: Version; right: Version }) {
  const say = useWords(), tell = useTold();
  const strokes = compare.per_stroke.map((stroke) => stroke.stroke);
  const stroke = strokes.find((number) => String(number) === query.stroke) ?? tellingStroke(compare);
  const one = usePicture(stroke, right.version, compare), other = usePicture(stroke, left.version, compare);
  if (stroke === undefined) return null;
  return (
    <section class="version-pair">
      <h3>{say("confirmStroke")}</h3>
      <label>{say("compareStroke")} <select name="pair-stroke" value={stroke} onChange={(e) => setUrl({ stroke: e.currentTarget.value })}>
        {strokes.map((number) => <option key={number} value={number}>{number}</option>)}
      </select></label>
      {one === undefined || other === undefined ? <p class="empty">{say("loading")}</p>
        : one === null || other === null ? <p class="empty">{say("confirmNoPicture")}</p>
        : <Outputs picture={one} before={other} parent={left.version} region={[]} output={tell(session.machine!, "output").text} chosen={query.output} choose={(output) => setUrl({ output })} />}
    </section>
  );
}

export function Save({ session }: { session: Session }) {
  const say = useWords();
  const [name, setName] = useState(session.machine!.suggested_file);
  const [told, setTold] = useState("");
  const { problem, attempt } = useAttempt();
  const save = () => attempt(async () => {
    const { path } = await post<{ path: string }>("save", { name });
    setTold(path);
    await refresh();
  });
  const download = async () => {
    const text = await fetch("/api/v1/machine").then((answer) => answer.text());
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
    link.download = session.machine!.suggested_file;
    link.click();
    URL.revokeObjectURL(link.href);
  };
  return (
    <section class="save">
      <h2>{say("saveTitle")}</h2>
      <p>{session.login ? say("saveNot") : session.unsaved ? say("saveText") : say("allSaved")}</p>
      {!session.file && !session.login && <label>{say("saveName")} <input name="file" value={name} onInput={(e) => setName(e.currentTarget.value)} /></label>}
      {!session.login && <button class="primary" disabled={!session.unsaved} onClick={() => void save()}>{session.file ? say("saveTo", { file: session.file.split("/").pop()! }) : say("save")}</button>}
      <button class="quiet" onClick={() => void download()}>{say("download")}</button>
      {told && <p role="status" class="saved" data-saved={told}>{say("saved", { path: told })}<br />{say("saveNext")} <code class="command">hydroscope {session.machine!.closed_loop ? "explain" : session.machine!.valve_alone ? "frf" : "fit"} LOG --machine {told}</code></p>}
      <Problem of={problem} />
    </section>
  );
}
