import type { ComponentChildren } from "preact";
import { Told } from "../told";
import type { Effect } from "../types";
import { useWords } from "../words";

/** A table that scrolls by itself where the window is narrow. */
export function Scroll({ label, children }: { label: string; children: ComponentChildren }) {
  return <div class="scroll" role="region" aria-label={label} tabIndex={0}>{children}</div>;
}

/** What an effect is called; its id if it is not in the library. */
export function TitleOf({ id, effects }: { id: string; effects: Effect[] }) {
  const effect = effects.find((e) => e.id === id);
  return effect?.title ? <Told of={effect} what="title" /> : <>{id}</>;
}

/** The text of the command, word for word. */
export function AsPrinted({ text }: { text: string }) {
  const say = useWords();
  return <details class="printed"><summary>{say("asPrinted")}</summary><pre lang="en" tabIndex={0}>{text}</pre></details>;
}
