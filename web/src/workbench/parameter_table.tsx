import { useContext } from "preact/hooks";
import { parameterName } from "../effect_titles";
import type { Parameters } from "../types";
import { withInterval, type Units } from "../units";
import { LanguageContext, useWords } from "../words";
import { Scroll } from "./parts";

/** The parameters of two versions of a model side by side. */
export function ParameterTable({ left, right, names, units }: { left: Parameters | null; right: Parameters | null; names: [string, string]; units: Units }) {
  const say = useWords(), language = useContext(LanguageContext);
  const all = [...new Set([...Object.keys(left ?? {}), ...Object.keys(right ?? {})])];
  const cell = (parameters: Parameters | null, name: string) => (parameters?.[name] ? withInterval(parameters[name], units) : "–");
  return (
    <Scroll label={say("parameter")}>
      <table class="versions-table cards" role="table">
        <thead><tr role="row">{[say("parameter"), ...names].map((name) => <th key={name} role="columnheader">{name}</th>)}</tr></thead>
        <tbody>{all.map((name) => <tr key={name} role="row"><th scope="row" role="rowheader">{parameterName(name, language)}</th><td role="cell" data-label={names[0]}>{cell(left, name)}</td><td role="cell" data-label={names[1]}>{cell(right, name)}</td></tr>)}</tbody>
      </table>
    </Scroll>
  );
}
