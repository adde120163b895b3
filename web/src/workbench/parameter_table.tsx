import type { Parameters } from "../types";
import { useWords } from "../words";
import { useParameters } from "./parameters";
import { Scroll } from "./parts";

/** The parameters of two versions of a model side by side. */
export function ParameterTable({ left, right, names }: { left: Parameters | null; right: Parameters | null; names: [string, string] }) {
  const say = useWords(), { nameOf, valueOf } = useParameters();
  const all = [...new Set([...Object.keys(left ?? {}), ...Object.keys(right ?? {})])];
  const cell = (parameters: Parameters | null, name: string) => (parameters?.[name] ? valueOf(name, parameters[name]) : "–");
  return (
    <Scroll label={say("parameter")}>
      <table class="versions-table cards" role="table">
        <thead><tr role="row">{[say("parameter"), ...names].map((name) => <th key={name} role="columnheader">{name}</th>)}</tr></thead>
        <tbody>{all.map((name) => <tr key={name} role="row"><th scope="row" role="rowheader">{nameOf(name)}</th><td role="cell" data-label={names[0]}>{cell(left, name)}</td><td role="cell" data-label={names[1]}>{cell(right, name)}</td></tr>)}</tbody>
      </table>
    </Scroll>
  );
}
