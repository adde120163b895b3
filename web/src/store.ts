// What the page knows: the session of work and the results for the version of the model in force.

import { ApiError, bringToken, find, get, listen, post, whenLoggedOut } from "./api";
import { knowEffects } from "./effect_titles";
import { failureOf, type Failure } from "./failure";
import { Outside } from "./outside";
import { shareOfVariation } from "./units";
import { pageLanguage, sayIn } from "./words";
import type { CheckResult, CompareResult, Effect, ExplainResult, Job, LogPicture, LoopChanges, LoopResult, Session } from "./types";

export interface Results { check?: CheckResult; compare?: CompareResult; explain?: ExplainResult; picture?: LogPicture }
type Kind = keyof Results;
/** The same of a machine in closed loop. */
export const ofLoop = (results: Results) => ({ response: results.compare as unknown as LoopResult | undefined, changes: results.explain as unknown as LoopChanges | undefined });
const kinds: Kind[] = ["compare", "check", "picture", "explain"];  // what takes longest last
const ofAnyLog: Kind[] = ["check", "picture"];  // of a valve alone, which has nothing else

interface State {
  session: Session | null;
  /** Nothing may be looked at before somebody logs in; what was looked at before, and what was typed, is kept. */
  locked: boolean;
  /** Whether there is somebody who could. */
  anyUsers: boolean;
  effects: Effect[];
  results: Results;
  /** Why a result is not there, by kind. */
  failed: Record<string, Failure>;
  jobs: Record<number, Job>;
  connected: boolean;
}

const store = new Outside<State>({ session: null, locked: false, anyUsers: true, effects: [], results: {}, failed: {}, jobs: {}, connected: true });
const set = (change: Partial<State>) => store.set(change);
const waiting = new Map<number, { kind: string; ended: (job: Job) => void }>();

export const useStore = (): State => store.use();

/** Starts long work and waits for its end. */
export async function work(kind: string, more: object = {}, path = "work"): Promise<void> {
  const { job } = await post<{ job: number }>(path, { kind, ...more });
  const ended = await new Promise<Job>((resolve) => {
    const known = store.now.jobs[job];
    if (known && (known.state === "done" || known.state === "failed")) resolve(known);
    else waiting.set(job, { kind, ended: resolve });
  });
  if (ended.state === "failed") throw new ApiError(0, ended.error ?? "", ended.german?.error);
}

/** Errors of several outputs together are shares, and read as percent. Changes `of`, which has a `unit` of errors, and gives it back. */
export function withShares<T extends { unit?: string } | null | undefined>(of: T): T {
  if (of && of.unit === "1" && store.now.session?.machine?.states) of.unit = shareOfVariation;
  return of;
}

async function sessionNow(): Promise<Session> {
  const session = await get<Session>("session");
  if (session.machine?.states) for (const version of session.versions) if (version.unit === "1") version.unit = shareOfVariation;
  return session;
}

let turn = 0;  // of working everything out: what an earlier one finds counts no more

/** Everything that is not worked out yet for the version in force is. */
async function workOut(kind: Kind, version: number) {
  const begun = turn;
  try {
    const known = () => find<{ unit?: string }>("results", { kind, version });
    let result = await known();
    if (!result) {
      await work(kind);
      result = await known();
    }
    if (!result || begun !== turn || store.now.session?.machine?.version !== version) return;
    set({ results: { ...store.now.results, [kind]: withShares(result) } });
    const judged = store.now.session.versions.find((one) => one.current);
    if (kind === "compare" && judged?.rms_holdout === null) set({ session: await sessionNow() });  // which tells the errors of this version
  } catch (caught) {
    if (begun === turn) set({ failed: { ...store.now.failed, [kind]: failureOf(caught) } });
  }
}

/** What is told of a job: by an event, or by the session if that event was lost. */
function hearOfJob(job: Job) {
  set({ jobs: { ...store.now.jobs, [job.job]: job } });
  if (job.state !== "done" && job.state !== "failed") return;
  waiting.get(job.job)?.ended(job);
  waiting.delete(job.job);
}

let shown = "";  // what the results belong to: logs, version, library, what was measured

export async function refresh(): Promise<void> {
  const session = await sessionNow();
  bringToken(session.user?.token ?? "");
  const locked = session.login !== null && session.login.to_read && session.user === null;
  set({ locked, anyUsers: session.login?.users ?? true });
  if (locked) return;
  session.jobs.filter((job) => waiting.has(job.job)).forEach(hearOfJob);
  const now = session.machine && session.logs.length > 0
    ? JSON.stringify([session.logs, session.machine.name, session.machine.version, session.machine.own_effects, session.measured]) : "";
  if (now === shown) return set({ session });
  shown = now;
  ++turn;
  set({ session, results: {}, failed: {} });
  if (!session.machine || now === "") return;
  for (const kind of session.machine.valve_alone ? ofAnyLog : kinds) void workOut(kind, session.machine.version);
  const { effects } = await get<{ effects: Effect[] }>("effects");
  knowEffects(effects);
  set({ effects });
}

/** The stream stands again, of a program that may be another one, which counts its jobs anew. */
async function comeBack() {
  shown = "";
  const left = [...waiting];
  set({ jobs: {} });
  await refresh();
  const { jobs } = store.now.session ?? { jobs: [] };
  for (const [job, { kind, ended }] of left) {
    if (!waiting.has(job) || jobs.some((known) => known.job === job && known.kind === kind)) continue;
    waiting.delete(job);
    const lost = sayIn(pageLanguage())("lost");
    ended({ job, kind, state: "failed", error: lost, german: { error: lost } });
  }
}

type Hearer = (event: Record<string, unknown>) => void;
const hearers = new Set<Hearer>();
/** Every event of the stream is passed on, and {state: "connected"} when it stands again. */
export function hear(hearer: Hearer): void {
  hearers.add(hearer);
}

export function start(): void {
  whenLoggedOut(() => { if (store.now.session?.user) void refresh(); });
  listen((event) => {
    for (const hearer of hearers) hearer(event);
    if (event.job === undefined && event.state !== "changed") return;
    if (event.state === "changed") return void refresh();
    hearOfJob(event as unknown as Job);
  }, (connected) => {
    if (connected && !store.now.connected) {
      void comeBack();
      for (const hearer of hearers) hearer({ state: "connected" });
    } else if (connected && waiting.size > 0) {
      void refresh();  // of what ended before the stream stood no event comes
    }
    if (connected !== store.now.connected) set({ connected });
  });
  void refresh().catch(() => set({ connected: false }));
}
