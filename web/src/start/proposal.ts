// The machine file that is being made for a log: what is asked for, and what the program answers.

import { useCallback, useEffect, useRef, useState } from "preact/hooks";
import { find, post } from "../api";
import { failureOf, type Failure } from "../failure";
import { refresh, useStore, work } from "../store";
import { forgetTyped } from "../typed";
import type { GateBound, LogPicture, Pin, Proposal, ProposalRequest } from "../types";

/** Under which what is written of a machine of one's own is kept. */
export const ownTyped = "own machine";

const writtenOnly = ["model", "balance", "effects"];  // what changes nothing of the log that is drawn

/** The pins with one of them changed; a column is on one pin only. */
const moved = (pins: Pin[], signal: string, column: string, unit: string): Pin[] =>
  pins.map((pin) => pin.signal === signal ? { ...pin, column, unit } : pin.column === column ? { ...pin, column: null } : pin);

/** A unit that was read from the log is read from it again: only one that was chosen is said. */
const columnsOf = (pins: Pin[], chosen: Record<string, string>): ProposalRequest["columns"] =>
  pins.filter((pin) => pin.column).map((pin) => ({ column: pin.column!, signal: pin.signal, unit: chosen[placeOf(pin.signal, pin.column!)] ?? "" }));

const placeOf = (signal: string, column: string) => `${signal} ← ${column}`;

export type ProposalWork = ReturnType<typeof useProposal>;

export function useProposal() {
  const { session } = useStore();
  const [proposal, setProposal] = useState<Proposal | null>(null);
  const [awaited, setAwaited] = useState<string | null>(null);  // the kind of machine whose proposal is not here yet
  const [picture, setPicture] = useState<LogPicture | null>(null);
  const [problem, setProblem] = useState<Failure | null>(null);
  const asked = useRef<ProposalRequest>(session?.mapping ?? {});
  const chosenUnits = useRef<Record<string, string>>(Object.fromEntries((asked.current.columns ?? []).map(({ signal, column, unit }) => [placeOf(signal, column), unit])));
  const latest = useRef(0), drawn = useRef(false);
  const [answered, setAnswered] = useState(0), [writing, setWriting] = useState<"no" | "whole" | "in part">("no");  // what is not asked about yet

  /** Asks with the change; until the answer is here it is shown, so that a second change builds on the first. False: it failed. */
  const propose = useCallback(async (change: ProposalRequest, shown: Partial<Proposal> = {}): Promise<boolean> => {
    asked.current = { ...asked.current, ...change };
    setWriting("no");
    setProposal((before) => before && { ...before, ...shown });
    const turn = ++latest.current, keys = Object.keys(change);
    if (keys.length === 0 || keys.some((key) => !writtenOnly.includes(key))) drawn.current = false;  // also if a later answer overtakes this one
    try {
      const answer = await post<Proposal>("proposal", asked.current);
      if (turn !== latest.current) return true;
      setProposal(answer);
      setAwaited(null);
      setAnswered(turn);
      setProblem(null);
      if (answer.problem && !answer.balance) {
        drawn.current = false;
        setPicture(null);
      } else if (!drawn.current) {
        await work("picture");
        const picture = await find<LogPicture>("results", { kind: "picture" });
        if (turn === latest.current) { drawn.current = true; setPicture(picture); }
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

  const put = (signal: string, column: string, unit = "") => {
    const pins = moved(proposal!.pins, signal, column, unit);
    if (unit) chosenUnits.current[placeOf(signal, column)] = unit;
    void propose({ model: proposal!.model, columns: columnsOf(pins, chosenUnits.current) }, { pins });
  };
  const setGate = (gate: GateBound[]) => void propose({ gate: gate.map(({ si: _, ...said }) => said) }, { gate });
  const takeKind = async (model: string) => {
    const before = [asked.current, chosenUnits.current] as const;
    asked.current = {};  // what was said of another machine
    chosenUnits.current = {};
    setAwaited(model);
    drawn.current = false;
    setPicture(null);
    if (!await propose({ model })) [asked.current, chosenUnits.current] = before;
  };
  /** The kind that was recognised counts as chosen, with all that is proposed: names of signals stay while one writes. */
  const keepKind = () => void propose({ model: proposal!.model, columns: columnsOf(proposal!.pins, chosenUnits.current),
    balance: proposal!.balance ?? undefined, effects: proposal!.effects ?? undefined });
  const setGeometry = (name: string, value: number | null) => {
    const geometry = { ...asked.current.geometry };
    if (value === null) delete geometry[name]; else geometry[name] = value;
    void propose({ geometry });
  };
  const accept = async () => {
    forgetTyped(ownTyped);
    await post("accept");
    location.hash = "step=check";
    await refresh();
  };
  return { proposal, awaited, picture, problem, propose, put, write: (whole: boolean) => setWriting(whole ? "whole" : "in part"), setGate, takeKind, keepKind, setGeometry, accept,
    chosen: Boolean(asked.current.model), settled: answered === latest.current && writing === "no", inPart: writing === "in part" };
}
