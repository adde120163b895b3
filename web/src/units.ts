// Numbers as the command line prints them: in the units people read, with few digits.

import type { Parameter, Unit } from "./types";

export type Units = Record<string, Unit>;

let comma = false;

/** German numbers have a decimal comma. */
export function writeNumbersIn(language: string): void {
  comma = language === "de";
}

const written = (number: string) => (comma ? number.replace(".", ",") : number);

export function short(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return written(value.toExponential(digits - 1));
  return written(String(Number(value.toPrecision(Math.max(digits, Math.ceil(Math.log10(size + 1)))))));
}

export function unitOf(units: Units, si: string): Unit {
  return units[si] ?? { factor: 1, offset: 0, name: si };
}

export function unitName(unit: Unit): string {
  return unit.name === "1" || unit.name === "-" ? "" : unit.name;
}

/** "12202 ± 424 bar": the half width of the 95 % interval, both with its two digits. */
export function withInterval(parameter: Parameter, units: Units): string {
  const unit = unitOf(units, parameter.unit);
  const value = parameter.value * unit.factor + unit.offset;
  const name = unitName(unit);
  if (parameter.std === null || !Number.isFinite(parameter.std)) return `${short(value)} ${name}`.trim();
  const half = 1.96 * parameter.std * unit.factor;
  const exponent = Math.floor(Math.log10(Math.max(Math.abs(value), half, 1e-300)));
  const scale = exponent < -3 || exponent > 6 ? 10 ** exponent : 1;
  const decimals = half > 0 ? Math.min(8, Math.max(0, 1 - Math.floor(Math.log10(half / scale)))) : 3;
  const numbers = `${written((value / scale).toFixed(decimals))} ± ${written((half / scale).toFixed(decimals))}`;
  return `${scale === 1 ? numbers : `(${numbers})e${exponent}`} ${name}`.trim();
}
