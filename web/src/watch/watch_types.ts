// What /api/v1/watch/... answers (docs/page.md). SI units; numbers that are not known are null.

import type { Titled } from "../effect_titles";
import type { Failure } from "../failure";

export type MaybeNumber = number | null;

export interface WatchedUnit { si: string; factor: number; offset: number; name: string; symbol: string; meaning: string; german?: { meaning: string; sentence?: string }; sentence: string; relative: boolean }
export interface Health { letter: "F" | "C" | "S" | "M" | "-"; reason: string; text: string; learned: number; needed: number; live: boolean; german: string }
export interface AgainstReference {
  value: MaybeNumber; deviation: MaybeNumber; std: MaybeNumber; smallest: MaybeNumber; strokes: number; moved: boolean; percent: MaybeNumber; percent_std?: number;
}
export interface WatchedParameter {
  parameter: string; unit: WatchedUnit; reference: AgainstReference | null; trend: boolean;
  value?: MaybeNumber; std?: MaybeNumber; reason?: string; reason_text?: string; german?: { reason_text: string }; spark?: MaybeNumber[];
}
export interface WatchedMachine {
  machine: string; counted: "stroke" | "episode"; health: Health; strokes: number; runs: number; last_s: MaybeNumber; dated: boolean; oil_temperature_K: MaybeNumber;
  model_version: number; effects: string[]; reference_version: number; judged_to: number; alarms: number; parameters: WatchedParameter[];
  /** What makes the newest values doubtful. */
  warnings: string[]; german?: { warnings: string[] };
}
export interface Overview {
  database: string; service: boolean; journal: boolean; user: string; problem: Failure | null;
  /** The libraries of all machines. */
  effects: Titled[];
  machines: WatchedMachine[]; presses: { machine: string; alarms: number }[];
}

export interface Alarm {
  machine: string; alarm: string; state: string; severity: "advisory" | "warning" | "alarm" | "signal_loss"; at_rest: boolean; active: boolean;
  acknowledged: boolean; shelved_until_s: MaybeNumber; out_of_service: boolean; value: MaybeNumber; std: MaybeNumber; limit: MaybeNumber; unit: string; shown: { factor: number; name: string };
  text: string; finding: string; evidence: string; action: string; cause: string; german: { finding: string; evidence: string; action: string; cause: string } | null;
  raised_stroke: number; raised_wall_s: number; raised_time_s: MaybeNumber; first_stroke: number; last_stroke: number;
}
export interface JournalRow {
  sequence: number; machine: string; wall_s: number; time_s: MaybeNumber; stroke: number; alarm: string; event: string; state_before: string; state: string;
  user: string; comment: string; text: string;
}

/** `stroke`: as many as there are of what was since the last one; `time_s`: that of the stroke where it is null. */
export interface Mark { kind: "alarm" | "cleared" | "reference" | "model" | "valve_check"; stroke: number; time_s: MaybeNumber; name: string; text: string; german?: { name: string; text: string } }
export interface Bins {
  first: number[]; last: number[]; run: number[]; begin_s: MaybeNumber[]; end_s: MaybeNumber[];
  low: MaybeNumber[]; high: MaybeNumber[]; mean: MaybeNumber[]; std: MaybeNumber[]; oil_temperature_K: MaybeNumber[];
}
export interface Trend {
  machine: string; parameter: string; first: number; end: number; strokes: number; width: number; exact: boolean; dated: boolean;
  bins: Bins; marks: Mark[]; limits: { name: string; value: number }[];
  healthy: null | {
    value: MaybeNumber[]; std: MaybeNumber[]; by_oil: MaybeNumber[]; compensates: boolean; middle_K: number;
    curve: null | { form: string; low_K: number; high_K: number; oil_temperature_K: number[]; value: number[]; std: number[] };
  };
}
export interface StrokeSignals { stroke: number; begin_s: number; end_s: number; time_s: number[]; signals: { name: string; unit: { factor: number; offset: number; name: string }; values: MaybeNumber[] }[] }
export interface Figure { value: MaybeNumber; std: MaybeNumber }
export interface ValveCheck {
  time_s: MaybeNumber; outcome: string; detail: string; german?: { detail: string }; f0_hz: Figure; damping: Figure; gain: Figure; dead_time_s: Figure; bandwidth_hz: Figure;
  amplitude: MaybeNumber; supply_pressure_Pa: MaybeNumber; oil_temperature_K: MaybeNumber;
}
/** `scaling` is how the value becomes the unit people read: "x 1e-05 = bar". */
export interface Tag { feed: string; axis: string; address: string; name: string; type: string; unit: string; scaling: string; meaning: string; value: string }
export interface FeedLink { name: string; connected: boolean; state: string; german?: { state: string }; clients: number; behind: number }
/** What speaks against strokes that are to be learned, and the reference that came of them. */
export interface Learning {
  first: number; last: number; refused: boolean; doubts: { kind: string; text: string; german: string; refuses: boolean }[];
  learned: null | { reference_version: number; first_stroke: number; last_stroke: number };
}
/** What a running service tells of itself (`status --json`, docs/command_line.md). */
export interface ServiceStatus {
  machine: string; counted?: "stroke" | "episode"; database: string; state: string; uptime_s: number; limits: string; cpu_s: number; memory_bytes: number; descriptors: number; valve_check: string; german?: { limits: string; valve_check: string };
  sources: { name: string; connected: boolean; state: string; german?: { state: string }; age_s: MaybeNumber; rows: number; lost_rows: number; reconnects: number; malformed: number }[];
  channels: { name: string; unit: string; rate_hz: number; age_s: MaybeNumber; value: MaybeNumber; noise_std: MaybeNumber; stale: boolean }[];
  axes: { name: string; strokes: number; counters: { missing_rows: number; late_rows: number; gaps: number } }[];
  feeds: FeedLink[];
  inbox: { batches: number; dropped_batches: number };
  writer: { state: string; problem: string; begun_anew: string; german?: { problem: string; begun_anew: string }; free_bytes: number; database_bytes: number; waiting_items: number; waiting_bytes: number;
    strokes: number; rows: number; dropped_rows: number; dropped_strokes: number; latency_p50_s: number; latency_p99_s: number; latency_max_s: number };
  drift: { problem: string; german?: { problem: string } };
  log?: { wall_s: number; level: string; text: string }[];
}
