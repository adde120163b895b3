import { LogView } from "../log_view";
import { MachinePicture } from "../start/machine_picture";
import { duration } from "../start/mapping";
import type { CheckResult, LogPicture, Session } from "../types";
import { short, unitName, unitOf } from "../units";
import { Told, ToldList } from "../told";
import { useWords } from "../words";
import type { Words } from "../words/en";
import { useParameters } from "./parameters";
import { AsPrinted, Scroll } from "./parts";

/** Why a parameter is not known well, and what to do about it. */
function Reason({ of }: { of: CheckResult["parameters"][string] }) {
  const said = { why: of.why ?? "", advice: of.advice ?? "", german: of.german };
  return <>{said.why && <Told of={said} what="why" />}{said.why && said.advice && ": "}{said.advice && <Told of={said} what="advice" />}</>;
}

/** What is wrong with the log and what makes conclusions from it doubtful, as the command tells it. */
function Standing({ check }: { check: CheckResult }) {
  const say = useWords();
  const { sampling, stopped } = check, read = [
    check.rejected_rows > 0 && say("checkRejected", { rows: check.rejected_rows }),
    sampling.gaps > 0 && say("checkGaps", { gaps: sampling.gaps, longest: duration(sampling.longest_gap_s) }),
  ].filter((text) => text !== false);
  const told = check.warnings.length > 0 || read.length > 0 || stopped || sampling.time_base;
  if (!told && check.hints.length === 0) return <div class="verdict good">{say(check.strokes === null || check.gate.conditions.length === 0 ? "checkNoHintsAlone" : "checkNoHints")}</div>;
  return (
    <div class="verdict bad">
      {check.hints.length > 0 && <><strong>{say("checkHints")}</strong><ul><ToldList of={check.hints} german={check.german?.hints} /></ul></>}
      {told && <><strong>{say("warnings")}</strong><ul>
        {stopped && <li>{say("checkStopped", { rows: check.rows })} <span lang="en">{stopped}</span></li>}
        {read.map((text) => <li key={text}>{text}</li>)}
        {sampling.time_base && <li><Told of={{ text: sampling.time_base, german: { text: check.german?.time_base } }} what="text" /></li>}
        <ToldList of={check.warnings} german={check.german?.warnings} />
      </ul></>}
    </div>
  );
}

/** Whether the log can be believed, and what can be learned from it. */
export function Check({ check, picture, session }: { check?: CheckResult; picture?: LogPicture; session: Session }) {
  const say = useWords(), { nameOf, meaningOf, valueOf } = useParameters();
  if (!check) return <p class="empty">{say("loading")}</p>;
  const heads = [say("checkSignal"), say("checkLow"), say("checkHigh"), say("checkNoise"), say("mapUnit"), say("checkFlags")];
  return (
    <>
      <h1>{say("checkTitle")}</h1>
      <p>{say(check.strokes === null ? "checkRowsAlone" : "checkRows", { rows: check.rows, duration: duration(check.duration_s), rate: short(check.sampling.rate_hz), strokes: check.strokes ?? "" })}</p>
      <Standing check={check} />
      <MachinePicture picture={session.machine!.picture} readings={check.signals.map((s) => ({ signal: s.signal, column: s.present ? s.column : null, state: s.present ? "sure" : "free" }))} />
      {picture && <LogView picture={picture} />}
      <Scroll label={say("checkSignal")}>
        <table class="cards labelled" role="table">
          <thead><tr role="row">{heads.map((head, k) => <th key={head} role="columnheader" class={k > 0 && k < 4 ? "num" : ""}>{head}</th>)}</tr></thead>
          <tbody>
            {check.signals.filter((signal) => signal.present).map((signal) => {
              const unit = unitOf(session.units, signal.unit);
              const shown = (value: number | null) => (value === null ? "–" : short(value * unit.factor + unit.offset, 4));
              const flags = Object.entries(signal.flags).map(([flag, { count }]) => `${count} × ${say(`flag_${flag}` as keyof Words)}`).join(", ");
              return (
                <tr key={signal.signal} role="row">
                  <th scope="row" role="rowheader">{signal.signal}</th>
                  {[shown(signal.min), shown(signal.max), signal.noise_std === null ? "–" : short(signal.noise_std * unit.factor, 2)].map((number, k) =>
                    <td key={k} role="cell" class={number === "–" ? "num nothing" : "num"} data-label={heads[k + 1]}>{number}</td>)}
                  <td role="cell" class="unit">{unitName(unit)}</td><td role="cell" data-label={heads[5]}>{flags || say("checkFine")}</td>
                </tr>
              );
            })}
          </tbody>
        </table>
      </Scroll>
      {Object.keys(check.parameters).length > 0 && <Scroll label={say("checkParameter")}>
        <table class="cards" role="table">
          <thead><tr role="row"><th role="columnheader">{say("checkParameter")}</th><th role="columnheader">{say("checkValue")}</th><th role="columnheader">{say("checkCan")}</th><th role="columnheader">{say("mapDecided")}</th></tr></thead>
          <tbody>
            {Object.entries(check.parameters).map(([name, parameter]) => (
              <tr key={name} role="row"><th scope="row" role="rowheader">{nameOf(name)} <small>{meaningOf(name)}</small></th><td role="cell">{valueOf(name, parameter)}</td>
                <td role="cell" data-label={say("checkCan")}>{say(`verdict_${parameter.verdict ?? "not"}`)}</td><td role="cell"><Reason of={parameter} /></td></tr>
            ))}
          </tbody>
        </table>
      </Scroll>}
      <AsPrinted text={check.text} />
    </>
  );
}
