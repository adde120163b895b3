import type { ComponentChildren } from "preact";
import { useWords } from "../words";

/** A table that scrolls by itself where the window is narrow. */
export function Scroll({ label, children }: { label: string; children: ComponentChildren }) {
  return <div class="scroll" role="region" aria-label={label} tabIndex={0}>{children}</div>;
}

/** The text of the command, word for word. */
export function AsPrinted({ text }: { text: string }) {
  const say = useWords();
  return <details class="printed"><summary>{say("asPrinted")}</summary><pre lang="en" tabIndex={0}>{text}</pre></details>;
}
