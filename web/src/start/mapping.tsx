import { useState } from "preact/hooks";
import { Problem } from "../failure";
import { byFinger } from "../pointer";
import { Told, ToldList, useTold } from "../told";
import type { Pin, Proposal } from "../types";
import { amount, printedUnit, short, shownNumber, withUnit } from "../units";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import { Area } from "./area";
import { BalanceFormula } from "./balance";
import { Columns } from "./columns";
import { GateOfLog } from "./gate_plot";
import { MachinePicture, type Reading } from "./machine_picture";
import { OwnMachine } from "./own_machine";
import { useProposal, type ProposalWork } from "./proposal";
import { Readiness } from "./readiness";
import { Sizes } from "./sizes";

const slowest = 50;  // rows a second below which valves and pressures are not seen

export function duration(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return "?";
  return seconds < 120 ? withUnit(short(seconds), "s") : seconds < 7200 ? withUnit(short(seconds / 60), "min") : withUnit(short(seconds / 3600), "h");
}

export const stateOf = (pin: Pin): Reading["state"] => (!pin.column ? (pin.required ? "missing" : "free") : pin.sure ? "sure" : "check");

/** What `init` proposes, to be looked at and put right: sensors, or the balance of a machine of one's own on a page of its own. */
export function FirstRun() {
  const say = useWords();
  const first = useProposal();
  const [{ page }] = useUrl();
  if (!first.proposal) return first.problem ? <Problem of={first.problem} /> : <p class="empty">{say("loading")}</p>;
  return page === "own" ? <OwnMachine first={first} /> : <Mapping first={first} />;
}

function Mapping({ first }: { first: ProposalWork }) {
  const say = useWords(), tell = useTold();
  const [, setUrl] = useUrl();
  const { awaited, problem, put, setGeometry } = first, proposal = first.proposal!;
  const takeKind = (model: string) => {
    if (proposal.kinds.find((kind) => kind.id === model)?.own) setUrl({ page: "own" });
    void first.takeKind(model);
  };
  const rate = proposal.duration_s ? (proposal.rows - 1) / proposal.duration_s : null, slow = rate !== null && rate < slowest;
  const areas = proposal.geometry.filter((known) => known.si === "m2" && known.required);
  return (
    <section class="mapping">
      <h1>{say("mapTitle")}</h1>
      <p class="kind"><label>{say("mapKind")} <select name="kind" value={awaited ?? proposal.model} onChange={(e) => takeKind(e.currentTarget.value)}>
        {proposal.kinds.map((kind) => <option key={kind.id} value={kind.id}>{tell(kind, "title").text}</option>)}
      </select></label> <span class="quiet">{say(first.chosen ? "mapChosen" : "mapRecognised")}</span></p>
      <p>{say(byFinger() ? "mapTap" : "mapDrag")} {say("mapText")}</p>
      <div class="two">
        <div>
          <h2>{say("mapColumns")}</h2>
          <Columns proposal={proposal} awaited={awaited !== null} />
        </div>
        <div>
          <h2>{say("mapSensors")}</h2>
          {awaited ? <p class="empty" role="status">{say("loading")}</p> : <>
            <MachinePicture picture={proposal.picture} readings={proposal.pins.map((pin) => ({ ...pin, state: stateOf(pin) }))} put={put} />
            <ul class="pins">
              {proposal.pins.map((pin) => (
                <PinRow key={pin.signal} pin={pin} proposal={proposal} put={put} />
              ))}
            </ul>
            {slow && <p class="verdict bad">{say("mapRate", { rate: short(rate) })} – {say("mapTooSlow")}</p>}
            {proposal.duration_s !== null && <p>{rate !== null && !slow && `${say("mapRate", { rate: short(rate) })}. `}{say("mapDuration", { duration: duration(proposal.duration_s) })}{!proposal.whole && <small> ({say("mapRowsOnly", { rows: proposal.rows })})</small>}</p>}
            {areas.map((area) => <Area key={`${proposal.model} ${area.name}`} known={area} set={(value) => setGeometry(area.name, value)} />)}
            <Sizes key={proposal.model} sizes={proposal.geometry.filter((known) => !areas.includes(known))} set={setGeometry} />
            {proposal.balance && <fieldset class="balance">
              <legend>{say("balanceTitle")}</legend>
              <BalanceFormula balance={proposal.balance} />
              <button onClick={() => setUrl({ page: "own" })}>{say("ownMachineGo")}</button>
            </fieldset>}
          </>}
        </div>
      </div>
      <GateOfLog first={first} />
      <Problem of={problem} />
      {!awaited && <>
        <details><summary>{say("mapDecided")}</summary>
          <ul class="decided"><ToldList of={proposal.decided} german={proposal.german?.decided} /><ToldList of={proposal.open} german={proposal.german?.open} /></ul></details>
        <details><summary>{say("mapFileText")}</summary><pre tabIndex={0}>{proposal.text}</pre></details>
        <Readiness first={first} />
      </>}
    </section>
  );
}

/** As people write them; of two spellings of one unit the last. */
const unitsByName = (units: string[]) => new Map(units.map((unit) => [printedUnit(unit), unit]));

export function PinRow({ pin, proposal, put }: { pin: Pin; proposal: Proposal; put: (signal: string, column: string, unit?: string) => void }) {
  const say = useWords(), tell = useTold();
  const [over, setOver] = useState(false);
  const state = stateOf(pin);
  const id = `pin-${pin.signal}`;
  return (
    <li class={`pin ${state}${over ? " over" : ""}`}
      onDragOver={(e) => { e.preventDefault(); setOver(true); }}
      onDragLeave={() => setOver(false)}
      onDrop={(e) => { e.preventDefault(); setOver(false); put(pin.signal, e.dataTransfer?.getData("text/plain") ?? ""); }}>
      <label for={id}><strong>{pin.signal}</strong> {tell(pin, "meaning").text !== pin.signal && <Told of={pin} what="meaning" />}</label>
      <select id={id} value={pin.column ?? ""} onChange={(e) => put(pin.signal, e.currentTarget.value)}>
        <option value="">{say("mapNone")}</option>
        {proposal.columns.filter((column) => column.numeric).map((column) => <option key={column.column} value={column.column}>{column.name}</option>)}
      </select>
      {pin.column && (
        <select aria-label={`${say("mapUnit")} ${pin.signal}`} value={pin.unit ?? ""} onChange={(e) => put(pin.signal, pin.column!, e.currentTarget.value)}>
          {[...unitsByName([...proposal.units, pin.unit ?? ""])].map(([name, unit]) => <option key={name} value={unit}>{name}</option>)}
        </select>
      )}
      <span class="says">
        {pin.column
          ? <>{pin.low !== undefined && `${short(shownNumber(pin.low, pin.shown_unit ?? ""))} … ${amount(pin.high, pin.shown_unit ?? "")}`} <em>{say(pin.sure ? "mapSure" : "mapCheck")}</em></>
          : <em>{say(pin.required ? "mapMissing" : "mapOptional")}</em>}
      </span>
      {pin.why && <small class="why"><Told of={{ why: pin.why, german: pin.german }} what="why" /></small>}
    </li>
  );
}
