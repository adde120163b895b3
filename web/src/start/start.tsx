import { useRef, useState } from "preact/hooks";
import { upload } from "../api";
import { failureOf, Problem, type Failure } from "../failure";
import { refresh, useStore, work } from "../store";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import type { Words } from "../words/en";

/** What one tries, and what failed of it. */
function useTaken() {
  const [busy, setBusy] = useState("");
  const [problem, setProblem] = useState<Failure | null>(null);

  const attempt = async (what: string, act: () => Promise<void>) => {
    setBusy(what);
    setProblem(null);
    try {
      await act();
      await refresh();
    } catch (caught) {
      setProblem(failureOf(caught));
    }
    setBusy("");
  };
  return { busy, problem, attempt };
}

/** A place to drop a log, or to choose one. */
export function DropLogs({ text }: { text: string }) {
  const say = useWords();
  const chooser = useRef<HTMLInputElement>(null);
  const [over, setOver] = useState(false);
  const { busy, problem, attempt } = useTaken();
  const take = async (files: File[]) => {
    // the machine file first: the log then goes straight to the workbench
    const order = [...files].sort((a, b) => Number(b.name.endsWith(".toml")) - Number(a.name.endsWith(".toml")));
    for (const file of order)
      await attempt(say("uploading", { name: file.name }), () => upload(file.name.endsWith(".toml") ? "machine" : "logs", file));
  };
  return (
    <>
      <div class={over ? "drop over" : "drop"}
        onDragOver={(e) => { e.preventDefault(); setOver(true); }}
        onDragLeave={() => setOver(false)}
        onDrop={(e) => { e.preventDefault(); setOver(false); void take([...(e.dataTransfer?.files ?? [])]); }}>
        <p class="big">{say("startDrop")}</p>
        <p>{text}</p>
        <button class="primary" onClick={() => chooser.current?.click()} disabled={busy !== ""}>{say("startChoose")}</button>
        <input ref={chooser} type="file" multiple hidden aria-label={say("startChoose")} accept=".csv,.gz,.txt,.dat,.mat,.toml"
          onChange={(e) => void take([...(e.currentTarget.files ?? [])])} />
        <p class="quiet">{say("startMachine")}</p>
      </div>
      {busy && <p role="status" class="busy">{busy}</p>}
      <Problem of={problem} />
    </>
  );
}

/** The first thing one sees: a place to drop a log, and examples. */
export function Start() {
  const say = useWords();
  const { session } = useStore();
  const { busy, problem, attempt } = useTaken();
  const [, setUrl] = useUrl();
  if (session && !session.changes) return <section class="start"><h1>{say("startTitle")}</h1><p>{session.user ? say("onlyView") : say("loginToAct")}</p></section>;
  return (
    <section class="start">
      <h1>{say("startTitle")}</h1>
      {session?.watched && <p>{say("startFromAlarm")}</p>}
      <DropLogs text={say("startText")} />
      {busy && <p role="status" class="busy">{busy}</p>}
      <Problem of={problem} />
      {(session?.examples.length ?? 0) > 0 && <h2>{say("startExamples")}</h2>}
      <div class="examples">
        {session?.examples.map((id) => (
          <button key={id} disabled={busy !== ""} onClick={() => void attempt(say("simulating"), () => work("example", { id }, "example"))}>
            {say(`example_${id}` as keyof Words)}
          </button>
        ))}
      </div>
      <p>{say("ownMachineOffer")} <button class="link" onClick={() => setUrl({ page: "own" })}>{say("ownMachineGo")}</button></p>
    </section>
  );
}
