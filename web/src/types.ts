// What the API answers (docs/page.md, docs/command_line.md). Numbers that are not known are null.

import type { Failure } from "./failure";

export interface Unit { factor: number; offset: number; name: string }

export interface Parameter {
  value: number; std: number | null; unit: string; reason?: string; identifiable?: boolean;
  verdict?: "good" | "weak" | "not"; why?: string; advice?: string; german?: { why: string; advice: string };
}
export type Parameters = Record<string, Parameter>;

export interface Version {
  version: number; name: string; effects: string[]; parent: number | null; current: boolean;
  rms_holdout: number | null; noise_floor: number | null; unit?: string; strokes?: number | null; parameters: Parameters;
}

export interface MachineInfo {
  name: string; title: string; version: number; effects: string[]; output: string; stroke: string; counted: "stroke" | "episode"; sign: string;
  states: boolean; closed_loop: boolean; valve: boolean; valve_alone: boolean; suggested_file: string; signals: string[]; own_effects: string[];
  german: { title: string; output: string; stroke: string; sign: string }; picture: Picture;
  parameters: Record<string, { symbol: string; meaning: string; shown: Unit | null; german: { meaning: string } }>;
}

export interface Job { job: number; kind: string; state: "waiting" | "running" | "done" | "failed"; what?: string; share?: number; error?: string; german?: { error: string } }

export interface Session {
  logs: { name: string; bytes: number | null; held_out: boolean }[];
  machine: MachineInfo | null;
  versions: Version[];
  units: Record<string, Unit>;
  results: string[];
  jobs: Job[];
  examples: string[];
  unsaved: boolean;
  file: string | null;
  /** What tests off the logs said of effects, SI. */
  measured: { effect: string; size: number; std: number }[];
  /** Strokes of the database that are worked on. */
  strokes: { machine: string; first: number; last: number } | null;
  /** What the last proposal was asked for with, and whether the machine file came of it. */
  mapping: ProposalRequest | null;
  mapped: boolean;
  /** A database is watched beside the logs. */
  watched: boolean;
  /** There is a workbench. */
  workbench: boolean;
  /** Who asks may change something. */
  changes: boolean;
  /** Who is logged in; on a page of one person that person. */
  user: User | null;
  /** Of the page of a service: whether looking needs a login too, and whether there is anybody who could. */
  login: { to_read: boolean; users: boolean } | null;
}
export interface User { name: string; role: "view" | "operate" | "admin"; token: string }

export interface CheckResult {
  rows: number; rejected_rows: number; duration_s: number; data_s: number; strokes: number | null; hints: string[]; warnings: string[]; stopped: string | null;
  german?: { hints: string[]; warnings: string[]; time_base: string };
  sampling: { rate_hz: number; fast_enough: boolean; gaps: number; longest_gap_s: number; time_base: string };
  signals: { signal: string; column: string; unit: string; present: boolean; min: number | null; max: number | null; noise_std: number | null;
    good: number; flags: Record<string, { count: number; first_s: number }> }[];
  gate: { share: number; too_short: number; conditions: { condition: string; share: number }[] };
  parameters: Parameters; text: string;
}

/** `output`, `error_unit`: of a machine with states, which output errs and in which unit. */
export interface Located { output?: string; error_unit?: string; signal: string; from: number; to: number; unit: string; rms: number; mean: number; share_error: number; share_windows: number }
export interface MapCell { from: number[]; to: number[]; rms: number; mean: number; mean_std: number; windows: number; strokes: number; above_floor: boolean }
export interface ErrorMap { output?: string; error_unit?: string; signals: string[]; units: string[]; explained: number; cells: MapCell[] }
/** How a model errs in a part of the operating space, and would with one more effect. */
export interface RegionErrors {
  windows: number; rms: number; noise: number; unit: string;
  strokes: { stroke: number; windows: number; rms: number; noise: number }[]; effects: { effect: string; rms: number }[];
}
/** `log`: the file that the stroke is of. */
/** `windows`, of episodes `rows`: how long it is. */
export interface StrokeError { stroke: number; windows?: number; rows?: number; log?: string; begin: number | null; rms_residual: number; noise_floor?: number; model_error: number; free_run_bar: number | null }

export interface HeldOut { log: string; strokes: number; rms: number; unit: string }

/** Strokes that differ from the rest and were left out, and how. */
export interface OddStrokes { strokes: number[]; set: string[]; parameter?: string; sentence: string; german?: { sentence: string } }

export interface CompareResult {
  held_out: HeldOut | null;
  rms_measured: number; rms_residual: number; noise_floor: number; rms_holdout: number; residual_percent: number; unit: string;
  strokes: number; strokes_described?: number; odd_strokes?: OddStrokes[]; verdict: string | null; model_error_seen: boolean | null; warnings: string[]; per_stroke: StrokeError[];
  free_run_bar: number | null; free_run_percent: number | null; located: Located[]; maps: ErrorMap[]; parameters: Parameters; text: string;
}

/** Of a machine in closed loop: its response (gain in dB, phase in degrees) at some frequencies. */
export interface LoopResult {
  set_point: string; input: string; output: string; seconds: number; warnings: string[]; model_reason?: string; german?: { warnings: string[]; model_reason?: string };
  model: Record<string, { value: number; std: number; unit: string }> | null; text: string;
  response: { f_hz: number[]; gain: number[]; gain_half: number[]; phase: number[]; phase_half: number[]; model_gain?: number[]; model_phase?: number[]; before_gain?: number[]; before_phase?: number[] };
}
/** How the response of a valve is measured, as the options of `frf`. */
export interface ValveOptions { method: string; segment: number; min_coherence: number; from: number; to: number | null; settle: number | null }
export interface ValvePoint {
  f_hz: number; gain: number; phase_deg: number; gain_std: number; phase_std_deg: number; coherence: number; amplitude: number;
  distortion?: number; periods: number; model_gain?: number; model_phase_deg?: number;
}
interface Known { value: number; std: number }
/** What `frf --json` says of a record beside its points. */
export interface ValveFigures {
  log: string; model: { f0_hz: Known; D: Known; K_v: Known; T_dead_s: Known } | null; model_reason?: string;
  bandwidth_3db_hz: number | null; bandwidth_3db_std_hz?: number; bandwidth_3db_extrapolated?: boolean;
  phase_90_hz: number | null; phase_90_std_hz?: number; phase_90_extrapolated?: boolean; t90_s?: number; t90_std_s?: number;
  first_order?: boolean; inflation?: number; chi_squared?: number; degrees_of_freedom?: number;
  supply_pressure_pa: number | null; oil_temperature_k: number | null; amplitude: number;
  curve: { f_hz: number[]; gain: number[]; phase: number[] } | null;
}
export interface ValveResult extends ValveFigures {
  method: "sine" | "welch"; input: string; output: string; points: ValvePoint[]; left_out: Record<string, number>; sample_rate_hz: number; segment_length: number;
  warnings: string[]; hint: string | null; german?: { warnings: string[]; hint: string; model_reason?: string };
  options: ValveOptions; before: ValveFigures | null; text: string;
}
/** Changes that together lead from before to now: factors, of delays seconds. */
export interface LoopSet { set: string[]; parameters: Record<string, { value: number; std: number; unit: string }> }
export interface LoopChanges {
  verdict: "adequate" | "named" | "ambiguous" | "unknown"; set: string[]; changes: LoopSet["parameters"]; others: LoopSet[]; imitators: LoopSet[];
  ranking: { effect: string; chi_squared: number; parameters: LoopSet["parameters"] }[]; input_limit: number | null; reversed: boolean;
  parameters: Record<string, { before: { value: number; std: number }; after: { value: number; std: number }; unit: string; change: number; relative: boolean }>;
  known: Record<string, { quantity: string; sentence: string; german: { quantity: string; sentence: string } }>;
  warnings: string[]; german?: { warnings: string[] }; text: string;
}

export interface Ranked {
  effect: string; rms_holdout: number | null; p_value: number; testable: boolean; why_not: string | null; german?: { why_not: string }; gain: number;
  significant?: boolean; fitted?: boolean; parameters: Parameters;
}
export interface Plan {
  strokes: number; speeds?: number[]; pressures?: number[]; rod_pressures?: number[]; warm_up?: number; seconds: number;
  signals?: { signal: string; speed: boolean; levels: [number, number][] }[];
}
export interface ProposedLaw { expression: string; rms_holdout: number; late_signal: string | null; sentence: string; german?: { sentence: string } }

export interface ExplainResult {
  verdict: "adequate" | "named" | "ambiguous" | "unknown"; set: string[]; groups: string[][]; partial: boolean; may_be_noise?: boolean; small_error?: boolean; slow?: boolean; short_runs?: boolean; astray?: boolean; doubtful?: boolean; only_zeros?: boolean; nearest?: string[]; noise_at_most?: boolean; doubt: string | null; german?: { doubt?: string; warnings: string[]; experiment?: string };
  warnings: string[]; noise_floor: number; unit: string; strokes: number; base: { rms_holdout: number };
  final: { rms_holdout: number; drifts?: Record<string, string>; german?: { drifts: Record<string, string> } }; ranking: Ranked[]; steps: { added: string | null; rms_holdout: number }[];
  odd_strokes?: OddStrokes[]; relatives?: { effect: string; sentence: string; german?: { sentence: string } }[];
  swap?: { out: string; in: string[]; rms_holdout_before: number; rms_holdout_after: number; explains?: boolean; proven?: boolean } | null;
  remainder?: { equation?: string; value_unit?: string; signal: string; unit: string; explained: number; points: { x: number; value: number; std: number }[] } | null;
  proposed_laws?: ProposedLaw[]; located?: Located[]; experiment: string | null; experiment_plan?: Plan | null; text: string;
}

export interface Effect {
  id: string; title: string; law: string; source: string; parameter: string; unit: string; plain: string; hidden_in: string;
  told_apart_by: string; measured_by: string; german?: { title: string; plain: string; told_apart_by: string; measured_by: string } | null; nonlinear: { name: string; unit: string }[];
}

export interface Preview {
  held_out: { log: string; before: number; after: number; unit: string } | null;
  effect: string; error: { before: number; after: number; noise_floor: number; unit: string } | null; warnings: string[]; german?: { warnings: string[] };
  parameters_before: Parameters | null; parameters_after: Parameters | null;
}

export interface StrokePicture {
  stroke: number; begin: number; step: number; unit: string; measured: number[]; modelled: number[]; noise: number[];
  signals: { name: string; unit: string; values: number[] }[];
  free_run: { signal: string; unit: string; step: number; measured: number[]; simulated: number[] } | null;
  with_effect?: number[] | null;  // modelled with the effect asked for
  outputs?: { name: string; unit: string; measured: number[]; modelled: number[]; noise: number }[];  // of a model with states
}

export interface LogPicture {
  from: number; step: number; duration_s: number; rows: number; discarded: number; no_strokes: Failure | null;
  signals: { name: string; unit: string; low: (number | null)[]; high: (number | null)[] }[];
  /** null: the machine has none. */
  strokes: { begin: number; end: number }[] | null;
  gate: GateCourse[];
}
/** What a bound of the gate looks at, SI. */
export interface GateCourse extends GateBound { si: string; step: number; low: (number | null)[]; high: (number | null)[] }

/** Where the name of a signal stands in the picture of its machine, and where its line leads to. */
export interface Place { signal: string; x: number; y: number; to_x: number; to_y: number; meaning: string; german?: { meaning: string } }
/** A machine as it is drawn: SVG elements of the program. */
export interface Picture { width: number; height: number; drawing: string; places: Place[] }
export interface Pin {
  signal: string; meaning: string; german?: { meaning: string; why?: string }; required: boolean; si: string; column: string | null; unit: string | null; why: string | null;
  sure: boolean; low?: number | null; high?: number | null; shown_unit?: string;
}
export interface LogColumn {
  column: string; name: string; unit: string; low: number | null; high: number | null; numeric: boolean; signal: string | null;
  thumbnail: { low: (number | null)[]; high: (number | null)[] };
}
export interface GateBound { signal: string; rate: boolean; magnitude: boolean; si?: string; min: number | null; max: number | null }
/** A size of the machine, SI, as a data sheet has it. */
export interface KnownSize {
  name: string; meaning: string; german?: { meaning: string }; required: boolean; si: string; unit: Unit;
  value: number | null; otherwise: number | null; lowest: number; highest: number;
}
/** Of a machine of one's own: the output is the sum of its terms, each a parameter times an expression over the signals. */
export interface Balance { output: string; terms: { name: string; expression: string }[] }
export interface WrittenEffect { id: string; expression: string; not_negative: boolean }
export interface ProposalRequest {
  model?: string; balance?: Balance; effects?: WrittenEffect[]; columns?: { column: string; signal: string; unit: string }[]; geometry?: Record<string, number>; gate?: GateBound[];
}
export interface Proposal {
  machine: string; model: string; title: string; german?: { title: string; decided: string[]; open: string[] }; picture: Picture; pins: Pin[]; columns: LogColumn[];
  kinds: { id: string; title: string; german?: { title: string }; own: boolean }[]; geometry: KnownSize[]; balance: Balance | null; effects: WrittenEffect[] | null;
  gate: GateBound[]; units: string[]; decided: string[]; open: string[]; rows: number; whole: boolean; duration_s: number | null; text: string;
  /** Why the machine file cannot be used yet. */
  problem: Failure | null;
}
