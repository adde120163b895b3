// Numbers and times of the database as people read them.

import { parameterName } from "../effect_titles";
import { halfText, unitName, withUnit } from "../units";
import { pageLanguage } from "../words";
import type { MaybeNumber, WatchedUnit } from "./watch_types";

export function inUnit(value: MaybeNumber | undefined, unit: WatchedUnit): MaybeNumber {
  return value === null || value === undefined ? null : value * unit.factor + unit.offset;
}

/** "12202 ± 424" of a value and its standard deviation; "–" where it is not known. */
export function interval(value: MaybeNumber | undefined, std: MaybeNumber | undefined): string {
  return value === null || value === undefined || !Number.isFinite(value) ? "–" : halfText(value, std === null || std === undefined ? null : 1.96 * std);
}

export function ofParameter(value: MaybeNumber | undefined, std: MaybeNumber | undefined, unit: WatchedUnit): string {
  return withUnit(interval(inUnit(value, unit), std === null || std === undefined ? null : std * Math.abs(unit.factor)), unitName(unit));
}

export const celsius = (kelvin: MaybeNumber) => (kelvin === null ? null : kelvin - 273.15);

const language = () => document.documentElement.lang || "en";

/** In the time zone of the reader, to the minute or to the second. */
export function dateText(seconds: number, timeStyle: "short" | "medium" = "short"): string {
  return new Intl.DateTimeFormat(language(), { dateStyle: "medium", timeStyle }).format(new Date(1000 * seconds));
}

/** Whether a time counts from 1970 rather than from the begin of a log. */
export const isDate = (seconds: MaybeNumber): seconds is number => seconds !== null && seconds > 1e9;

const greek: Record<string, string> = { alpha: "α", beta: "β", delta: "δ", Delta: "Δ", eta: "η", kappa: "κ", mu: "μ", omega: "ω", phi: "φ", rho: "ρ", sigma: "σ", tau: "τ", theta: "θ", zeta: "ζ" };

/** "Q_{vn}", "\\zeta_h" as the page writes them. */
export function plainSymbol(symbol: string): string {
  return symbol.replace(/\\(\w+?)(?![a-z])/g, (_, name: string) => greek[name] ?? name).replace(/[{}]/g, "");
}

/** What a parameter is called: its symbol, of an effect its title. */
export function symbolOf(unit: WatchedUnit): string {
  return plainSymbol(parameterName(unit.symbol, pageLanguage()));
}

export function download(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
