import { useCallback, useEffect, useRef, useState } from "preact/hooks";
import { find, post } from "../api";
import { failureOf, Problem, type Failure } from "../failure";
import { LogView } from "../log_view";
import { refresh, useStore, work } from "../store";
import type { GateBound, LogPicture, Pin, Proposal, ProposalRequest } from "../types";
import { Told, ToldList, useTold } from "../told";
import { amount, printedUnit, short, shownNumber, withUnit } from "../units";
import { useWords } from "../words";
import { Area } from "./area";
import { BalanceEditor } from "./balance";
import { GatePlots } from "./gate_plot";
import { GateThresholds } from "./gate_thresholds";
import { MachinePicture, type Reading } from "./machine_picture";
import { isOdd, Sizes, sizeText } from "./sizes";
import { Thumbnail } from "./thumbnail";

const slowest = 50;  // rows a second below which valves and pressures are not seen
const fewMissing = 4;  // that are named; of more their number is told

export function duration(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return "?";
  return seconds < 120 ? withUnit(short(seconds), "s") : seconds < 7200 ? withUnit(short(seconds / 60), "min") : withUnit(short(seconds / 3600), "h");
}

/** The pins with one of them changed; a column is on one pin only. */
const moved = (pins: Pin[], signal: string, column: string, unit: string): Pin[] =>
  pins.map((pin) => pin.signal === signal ? { ...pin, column, unit } : pin.column === column ? { ...pin, column: null } : pin);

/** A unit that was read from the log is read from it again: only one that was chosen is said. */
const columnsOf = (pins: Pin[], chosen: Record<string, string>): ProposalRequest["columns"] =>
  pins.filter((pin) => pin.column).map((pin) => ({ column: pin.column!, signal: pin.signal, unit: chosen[placeOf(pin.signal, pin.column!)] ?? "" }));

const placeOf = (signal: string, column: string) => `${signal} ← ${column}`;

const stateOf = (pin: Pin): Reading["state"] => (!pin.column ? (pin.required ? "missing" : "free") : pin.sure ? "sure" : "check");

/** What `init` proposes, to be looked at and put right. */
export function Mapping() {
  const say = useWords(), tell = useTold();
  const { session } = useStore();
  const [proposal, setProposal] = useState<Proposal | null>(null);
  const [awaited, setAwaited] = useState<string | null>(null);  // the kind of machine whose proposal is not here yet
  const [picture, setPicture] = useState<LogPicture | null>(null);
  const [problem, setProblem] = useState<Failure | null>(null);
  const asked = useRef<ProposalRequest>(session?.mapping ?? {});
  const chosenUnits = useRef<Record<string, string>>(Object.fromEntries((asked.current.columns ?? []).map(({ signal, column, unit }) => [placeOf(signal, column), unit])));
  const latest = useRef(0);
  const [answered, setAnswered] = useState(0);

  /** Asks with the change; until the answer is here it is shown, so that a second change builds on the first. False: it failed. */
  const propose = useCallback(async (change: ProposalRequest, shown: Partial<Proposal> = {}): Promise<boolean> => {
    asked.current = { ...asked.current, ...change };
    setProposal((before) => before && { ...before, ...shown });
    const turn = ++latest.current;
    try {
      const answer = await post<Proposal>("proposal", asked.current);
      if (turn !== latest.current) return true;
      setProposal(answer);
      setAwaited(null);
      setAnswered(turn);
      setProblem(null);
      if (answer.problem) setPicture(null);
      else {
        await work("picture");
        const drawn = await find<LogPicture>("results", { kind: "picture" });
        if (turn === latest.current) setPicture(drawn);
      }
    } catch (caught) {
      if (turn !== latest.current) return true;
      setProblem(failureOf(caught));
      setAwaited(null);
      return false;
    }
    return true;
  }, []);
  useEffect(() => void propose({}), [session?.logs.length]);

  if (!proposal) return problem ? <Problem of={problem} /> : <p class="empty">{say("loading")}</p>;
  const put = (signal: string, column: string, unit = "") => {
    const pins = moved(proposal.pins, signal, column, unit);
    if (unit) chosenUnits.current[placeOf(signal, column)] = unit;
    void propose({ model: proposal.model, columns: columnsOf(pins, chosenUnits.current) }, { pins });
  };
  const setGate = (gate: GateBound[]) => void propose({ gate }, { gate });
  const takeKind = async (model: string) => {
    const before = [asked.current, chosenUnits.current] as const;
    asked.current = {};  // what was said of another machine
    chosenUnits.current = {};
    setAwaited(model);
    setPicture(null);
    if (!await propose({ model })) [asked.current, chosenUnits.current] = before;
  };
  const setGeometry = (name: string, value: number | null) => {
    const geometry = { ...asked.current.geometry };
    if (value === null) delete geometry[name]; else geometry[name] = value;
    void propose({ geometry });
  };
  const accept = async () => {
    await post("accept");
    location.hash = "step=check";
    await refresh();
  };
  const rate = proposal.duration_s ? (proposal.rows - 1) / proposal.duration_s : null, slow = rate !== null && rate < slowest;
  const missing = [...proposal.pins.filter((pin) => pin.required && !pin.column).map((pin) => ({ ...pin, name: pin.signal })),
    ...proposal.geometry.filter((known) => known.required && known.value === null)];
  const odd = proposal.geometry.find((known) => isOdd(known, known.value));
  const areas = proposal.geometry.filter((known) => known.si === "m2" && known.required);
  return (
    <section class="mapping">
      <h1>{say("mapTitle")}</h1>
      <p class="kind"><label>{say("mapKind")} <select name="kind" value={awaited ?? proposal.model} onChange={(e) => void takeKind(e.currentTarget.value)}>
        {proposal.kinds.map((kind) => <option key={kind.id} value={kind.id}>{tell(kind, "title").text}</option>)}
      </select></label> <span class="quiet">{say(asked.current.model ? "mapChosen" : "mapRecognised")}</span></p>
      <p>{say("mapText")}</p>
      <div class="two">
        <div>
          <h2>{say("mapColumns")}</h2>
          <ul class="columns" tabIndex={0} aria-label={say("mapColumns")}>
            {proposal.columns.map((column) => (
              <li key={column.column} draggable={column.numeric} class={column.signal ? "used" : "free"}
                onDragStart={(e) => e.dataTransfer?.setData("text/plain", column.column)}>
                <span class="name">{column.name}{column.unit && <small> {printedUnit(column.unit)}</small>}</span>
                <Thumbnail thumbnail={column.thumbnail} />
                <span class="range">{column.numeric ? `${short(column.low)} … ${short(column.high)}` : "–"}</span>
                <span class="role">{awaited ? "" : column.signal ? say("mapUsedAs", { signal: column.signal }) : say("mapUnused")}</span>
              </li>
            ))}
          </ul>
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
            {proposal.duration_s !== null && <p>{rate !== null && !slow && `${say("mapRate", { rate: short(rate) })}. `}{say("mapDuration", { duration: duration(proposal.duration_s) })} <small>({say("mapRowsOnly", { rows: proposal.rows })})</small></p>}
            {areas.map((area) => <Area key={`${proposal.model} ${area.name}`} known={area} set={(value) => setGeometry(area.name, value)} />)}
            <Sizes key={proposal.model} sizes={proposal.geometry.filter((known) => !areas.includes(known))} set={setGeometry} />
            {proposal.balance && <BalanceEditor key={proposal.model} proposed={proposal.balance} signals={proposal.pins.filter((pin) => pin.signal !== "time").map((pin) => pin.signal)}
              problem={proposal.problem} set={(balance) => void propose({ model: proposal.model, balance })} />}
          </>}
        </div>
      </div>
      {picture && <>
        <LogView picture={picture} />
        <p class="quiet">{say("gateDrag")}</p>
        <GatePlots picture={picture} bounds={proposal.gate} set={setGate} />
        <GateThresholds bounds={proposal.gate} pins={proposal.pins} set={setGate} />
      </>}
      <Problem of={problem} />
      {!awaited && <>
        <details><summary>{say("mapDecided")}</summary>
          <ul class="decided"><ToldList of={proposal.decided} german={proposal.german?.decided} /><ToldList of={proposal.open} german={proposal.german?.open} /></ul></details>
        <details><summary>{say("mapFileText")}</summary><pre tabIndex={0}>{proposal.text}</pre></details>
        <p class={proposal.problem || odd ? "verdict bad" : "verdict good"} role="status">
          {odd ? say("mapOdd", { what: odd.name, from: sizeText(odd, odd.lowest), to: sizeText(odd, odd.highest) })
            : !proposal.problem ? say("mapReady")
            : missing.length > 0 ? say("mapNeeds", { what: missing.slice(0, fewMissing).map((what) => `${what.name} (${tell(what, "meaning").text})`).join(", ") + (missing.length > fewMissing ? say("mapNeedsMore", { count: missing.length - fewMissing }) : "") })
            : proposal.balance?.output === "" ? say("balanceNeeded")
            : <>{say("mapNotReady")}<Told of={proposal.problem} what="error" /></>}
        </p>
        <button class="primary" disabled={proposal.problem !== null || odd !== undefined || answered !== latest.current} onClick={() => void accept()}>{say("mapGo")}</button>
      </>}
    </section>
  );
}

/** As people write them; of two spellings of one unit the last. */
const unitsByName = (units: string[]) => new Map(units.map((unit) => [printedUnit(unit), unit]));

function PinRow({ pin, proposal, put }: { pin: Pin; proposal: Proposal; put: (signal: string, column: string, unit?: string) => void }) {
  const say = useWords();
  const [over, setOver] = useState(false);
  const state = stateOf(pin);
  const id = `pin-${pin.signal}`;
  return (
    <li class={`pin ${state}${over ? " over" : ""}`}
      onDragOver={(e) => { e.preventDefault(); setOver(true); }}
      onDragLeave={() => setOver(false)}
      onDrop={(e) => { e.preventDefault(); setOver(false); put(pin.signal, e.dataTransfer?.getData("text/plain") ?? ""); }}>
      <label for={id}><strong>{pin.signal}</strong> <Told of={pin} what="meaning" /></label>
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
