import { useContext } from "preact/hooks";
import { parameterName } from "../effect_titles";
import { useStore } from "../store";
import { useTold } from "../told";
import type { Parameter } from "../types";
import { withInterval } from "../units";
import { plainSymbol } from "../watch/shown";
import { LanguageContext } from "../words";

/** How parameters of the machine worked on are named and shown, as trends and reports do. */
export function useParameters() {
  const { session } = useStore();
  const language = useContext(LanguageContext), tell = useTold();
  const known = session?.machine?.parameters ?? {}, units = session?.units ?? {};
  return {
    nameOf: (id: string) => (known[id] ? plainSymbol(known[id].symbol) : parameterName(id, language)),
    meaningOf: (id: string) => (known[id]?.meaning ? tell(known[id], "meaning").text : ""),
    valueOf: (id: string, parameter: Parameter) => withInterval(parameter, known[id]?.shown ? { ...units, [parameter.unit]: known[id].shown } : units),
  };
}
