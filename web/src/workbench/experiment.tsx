import type { ExplainResult, Plan } from "../types";
import { useStore } from "../store";
import { Told } from "../told";
import { dateText } from "../watch/shown";
import { nameOf, short, shownNumber, unitName, unitOf, withUnit, type Units } from "../units";
import { useWords } from "../words";
import { LogButtons } from "./logs";
import { Scroll } from "./parts";

/** What to record next so that the rivals can be told apart, as a table to print. */
export function Experiment({ explain, units }: { explain: ExplainResult; units: Units }) {
  const say = useWords(), { session } = useStore();
  if (!explain.experiment && !explain.experiment_plan) return null;
  return (
    <section class="experiment">
      <p class="print-only">{[session?.machine?.name, ...(session?.logs ?? []).map((log) => log.name), say("printed", { when: dateText(Date.now() / 1000) })].filter(Boolean).join(" · ")}</p>
      <h3>{say("experimentTitle")}</h3>
      {explain.experiment && <p class="lines"><Told of={{ experiment: explain.experiment, german: explain.german }} what="experiment" /></p>}
      {explain.experiment_plan && <>
        <Scroll label={say("experimentTitle")}><PlanTable plan={explain.experiment_plan} units={units} /></Scroll>
        <button class="quiet no-print" onClick={() => print()}>{say("print")}</button>
      </>}
      {session && !session.strokes && <LogButtons session={session} />}
    </section>
  );
}

function PlanTable({ plan, units }: { plan: Plan; units: Units }) {
  const say = useWords();
  const check = useStore().results.check;
  const list = (values: number[] | undefined, si: string) => {
    const unit = unitOf(units, si);
    return withUnit((values ?? []).map((v) => short(v * unit.factor)).join(", "), unitName(unit));
  };
  const speeds = (values: number[] | undefined) => withUnit((values ?? []).map((v) => short(shownNumber(1000 * v, "mm/s"))).join(", "), nameOf("mm/s"));
  const rows: [string, string][] = [[say("experimentStrokes"), String(plan.strokes)]];
  if (plan.speeds?.length) rows.push([say("experimentSpeeds"), speeds(plan.speeds)]);
  if (plan.pressures?.length) rows.push([say("experimentPressures"), list(plan.pressures, "Pa")]);
  if (plan.rod_pressures?.length) rows.push([say("experimentRod"), list(plan.rod_pressures, "Pa")]);
  if (plan.warm_up) rows.push([say("experimentWarm"), withUnit(short(plan.warm_up), "K")]);
  for (const s of plan.signals ?? []) {
    const unit = unitOf(units, check?.signals.find((known) => known.signal === s.signal)?.unit ?? "SI"), offset = s.speed ? 0 : unit.offset;
    const shown = (value: number) => short(value * unit.factor + offset);
    const levels = s.levels.map(([from, to]) => (from === to ? shown(from) : `${shown(from)} … ${shown(to)}`)).join("; ");
    rows.push([say(s.speed ? "experimentSpeedLevels" : "experimentLevels", { signal: s.signal }), withUnit(levels, s.speed ? `${unitName(unit) || "1"}/s` : unitName(unit))]);
  }
  rows.push([say("experimentSeconds"), withUnit(short(plan.seconds), "s")]);
  return (
    <table>
      <thead><tr><th>{say("experimentStep")}</th><th>{say("experimentValue")}</th></tr></thead>
      <tbody>{rows.map(([name, value]) => <tr key={name}><th scope="row">{name}</th><td>{value}</td></tr>)}</tbody>
    </table>
  );
}
