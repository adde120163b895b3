import type { Parameters } from "../types";
import { withInterval, type Units } from "../units";
import { useWords } from "../words";
import { Scroll } from "./parts";

/** The parameters of two versions of a model side by side. */
export function ParameterTable({ left, right, names, units }: { left: Parameters | null; right: Parameters | null; names: [string, string]; units: Units }) {
  const say = useWords();
  const all = [...new Set([...Object.keys(left ?? {}), ...Object.keys(right ?? {})])];
  const cell = (parameters: Parameters | null, name: string) => (parameters?.[name] ? withInterval(parameters[name], units) : "–");
  return (
    <Scroll label={say("parameter")}>
      <table class="versions-table">
        <thead><tr><th>{say("parameter")}</th><th>{names[0]}</th><th>{names[1]}</th></tr></thead>
        <tbody>{all.map((name) => <tr key={name}><th scope="row">{name}</th><td>{cell(left, name)}</td><td>{cell(right, name)}</td></tr>)}</tbody>
      </table>
    </Scroll>
  );
}
