import type { ComponentChildren } from "preact";
import { useStore } from "../store";
import { Told, useTold } from "../told";
import type { Effect } from "../types";
import { useWords } from "../words";

/** A table that scrolls by itself where the window is narrow. */
export function Scroll({ label, children }: { label: string; children: ComponentChildren }) {
  return <div class="scroll" role="region" aria-label={label} tabIndex={0}>{children}</div>;
}

/** A table whose rows become cards where the window is narrow. A row begins with what it is about. */
export function CardTable({ label, heads, rows, keys }: { label: string; heads: string[]; rows: ComponentChildren[][]; keys?: string[] }) {
  const align = heads.map((_, c) => (rows.every((row) => typeof row[c] === "number") ? "num" : undefined));
  return (
    <Scroll label={label}><table class="cards labelled" role="table">
      <thead><tr role="row">{heads.map((head, c) => <th key={head} scope="col" role="columnheader" class={align[c]}>{head}</th>)}</tr></thead>
      <tbody>{rows.map((row, k) => (
        <tr key={keys?.[k] ?? k} role="row">{row.map((cell, c) => (c === 0
          ? <th key={c} scope="row" role="rowheader" class="leads">{cell}</th>
          : <td key={c} role="cell" class={align[c]} data-label={heads[c]}>{cell}</td>))}</tr>))}</tbody>
    </table></Scroll>
  );
}

/** What an effect is called; its id if it is not in the library. */
export function TitleOf({ id, effects }: { id: string; effects: Effect[] }) {
  const effect = effects.find((e) => e.id === id);
  return effect?.title ? <Told of={effect} what="title" /> : <>{id}</>;
}

/** What a model with these effects is called. */
export function useModelName(): (effects: string[]) => string {
  const say = useWords(), tell = useTold();
  const { effects: library } = useStore();
  return (effects) => {
    const titles = effects.map((id) => { const known = library.find((effect) => effect.id === id); return known?.title ? tell(known, "title").text : id; });
    return titles.length > 0 ? `+ ${titles.join(" + ")}` : say("base");
  };
}

/** The text of the command, word for word. */
export function AsPrinted({ text }: { text: string }) {
  const say = useWords();
  return <details class="printed"><summary>{say("asPrinted")}</summary><pre lang="en" tabIndex={0}>{text}</pre></details>;
}
