// Numbers and times of the database as people read them.

import { parameterName } from "../effect_titles";
import { short, unitName } from "../units";
import { pageLanguage } from "../words";
import type { MaybeNumber, WatchedUnit } from "./watch_types";

export function inUnit(value: MaybeNumber | undefined, unit: WatchedUnit): MaybeNumber {
  return value === null || value === undefined ? null : value * unit.factor + unit.offset;
}

/** "12202 ± 424": the half width of the 95 % interval with two digits, the value with as many decimals. */
export function interval(value: MaybeNumber | undefined, std: MaybeNumber | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (std === null || std === undefined || !(std > 0)) return short(value, 4);
  const half = 1.96 * std;
  const decimals = Math.min(8, Math.max(0, 1 - Math.floor(Math.log10(half))));
  const comma = short(1.5).includes(",");
  const written = (n: number) => (comma ? n.toFixed(decimals).replace(".", ",") : n.toFixed(decimals));
  return `${written(value)} ± ${written(half)}`;
}

export function ofParameter(value: MaybeNumber | undefined, std: MaybeNumber | undefined, unit: WatchedUnit): string {
  const text = interval(inUnit(value, unit), std === null || std === undefined ? null : std * Math.abs(unit.factor));
  return `${text} ${unitName(unit)}`.trim();
}

export const celsius = (kelvin: MaybeNumber) => (kelvin === null ? null : kelvin - 273.15);

const language = () => document.documentElement.lang || "en";

export function dateText(seconds: number): string {
  return new Intl.DateTimeFormat(language(), { dateStyle: "medium", timeStyle: "short" }).format(new Date(1000 * seconds));
}

/** Whether a time counts from 1970 rather than from the begin of a log. */
export const isDate = (seconds: MaybeNumber): seconds is number => seconds !== null && seconds > 1e9;

/** "Q_{vn}" as the page writes it. */
export function plainSymbol(symbol: string): string {
  return symbol.replace(/[{}]/g, "");
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
