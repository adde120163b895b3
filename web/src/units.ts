// Numbers as people read them: in the units that the program prints or that they chose, with few digits.

import type { Parameter, Unit } from "./types";

export type Units = Record<string, Unit>;

/** Units to choose from, by quantity: how many of them make one of the first, which is the program's own. */
export const unitChoices = {
  pressure: { bar: 1, MPa: 0.1, kPa: 100, psi: 14.503773773 },
  flow: { "l/min": 1, "m³/h": 0.06, "cm³/s": 1000 / 60, "gal/min": 0.2641720524 },
  length: { mm: 1, cm: 0.1, m: 1e-3, in: 1 / 25.4 },
  volume: { l: 1, "cm³": 1000, "in³": 61.02374409, gal: 0.2641720524 },
  temperature: { "°C": 1, "°F": 1.8 },
} as const satisfies Record<string, Record<string, number>>;
export type Quantity = keyof typeof unitChoices;
export const quantities = Object.keys(unitChoices) as Quantity[];
export type ChosenUnits = Record<Quantity, string>;

const namesOf = (quantity: Quantity) => Object.keys(unitChoices[quantity]);
const own = Object.fromEntries(quantities.map((quantity) => [quantity, namesOf(quantity)[0]])) as ChosenUnits;

/** Those chosen last on this computer, else the program's own. */
export function firstUnits(): ChosenUnits {
  try {
    const kept = JSON.parse(localStorage.getItem("units") ?? "{}") as Partial<ChosenUnits>;
    return Object.fromEntries(quantities.map((q) => [q, namesOf(q).includes(kept[q] ?? "") ? kept[q] : own[q]])) as ChosenUnits;
  } catch {
    return own;
  }
}

let comma = false, chosen: ChosenUnits = own;
let known = new Map<string, Unit>();

/** German numbers have a decimal comma. */
export function writeNumbersIn(language: string): void {
  comma = language === "de";
}

export function showUnitsIn(units: ChosenUnits): void {
  if (unitsKey() === Object.values(units).join()) return;
  chosen = units;
  known = new Map();
}

/** Changes with the choice: pictures that hold numbers of before are drawn anew. */
export const unitsKey = () => Object.values(chosen).join();

/** Units whose names hold others: "l/min per bar", "bar/s", "l/min per sqrt(bar)", "mm2", "GPa". */
const parts: Record<string, [Quantity, number]> = { GPa: ["pressure", 1e4], bar: ["pressure", 1], "l/min": ["flow", 1], mm: ["length", 1], l: ["volume", 1] };
const part = /(?<![A-Za-z])(GPa|bar|l\/min|mm|l)(?![A-Za-z])/g;

/** Unit of an error that the program gives as a share of how much each output varies, as "1". */
export const shareOfVariation = "share of variation";

function convert(name: string): Unit {
  if (name === shareOfVariation) return { factor: 100, offset: 0, name: "%" };
  if (name === "°C") return { factor: (unitChoices.temperature as Record<string, number>)[chosen.temperature], offset: chosen.temperature === "°F" ? 32 : 0, name: chosen.temperature };
  let factor = 1;
  const written = name.replace(part, (word, _, at: number, all: string) => {
    const [quantity, size] = parts[word], before = all.slice(0, at), after = all.slice(at + word.length);
    const power = (before.endsWith("sqrt(") ? 0.5 : /^\)?(\^2|2|²)/.test(after) ? 2 : 1) * (/ per |\/$/.test(before) ? -1 : 1);
    factor *= (size * (unitChoices[quantity] as Record<string, number>)[chosen[quantity]]) ** power;
    return chosen[quantity];
  });
  return { factor, offset: 0, name: written };
}

/** How a number in the unit of this name, as the program prints it, becomes one in the unit chosen. */
export function shownUnit(name: string): Unit {
  let unit = known.get(name);
  if (!unit) known.set(name, (unit = convert(name)));
  return unit;
}

/** A unit of the program as the one chosen. */
export function inChosen<T extends Unit>(unit: T): T {
  const shown = shownUnit(unit.name);
  return { ...unit, factor: unit.factor * shown.factor, offset: unit.offset * shown.factor + shown.offset, name: shown.name };
}

/** A number that the program gives in the unit of this name. */
export function shownNumber<T extends number | null>(value: T, name: string): T {
  const unit = shownUnit(name);
  return (value === null ? null : value * unit.factor + unit.offset) as T;
}

const tie = "\u202f";  // a narrow space at which no line breaks

/** A number with its unit, in one line; before a unit of several words it may break. */
export const withUnit = (number: string, unit: string) => (!unit ? number : unit.includes(" ") ? `${number} ${unit.replace(/ /g, "\u00a0")}` : `${number}${tie}${unit}`);

const named = /(?<=\d) (?=(?:%|°|(?:[kMG]?Pa|bar|psi|[lm]|l\/min|m[ms³²]?|mm\/s|cm[²³]?|gal|[kM]?N|k?Hz|m?s|min|h|m?[AV]|K|kg|rad|dB|[kMGT]B)(?![\wäöüß'(])))/g;

/** A sentence in which numbers keep to their units. */
export const kept = (sentence: string) => sentence.replace(named, tie).replace(/ ± (?=\d)/g, `${tie}±${tie}`);

/** "12.3 MPa" of a number that the program gives in bar. */
export function amount(value: number | null | undefined, name: string, digits = 3): string {
  return value === null || value === undefined ? "–" : withUnit(short(shownNumber(value, name), digits), nameOf(name));
}

/** The name of the unit chosen for one of this name; "" of a plain number. */
export const nameOf = (name: string) => unitName(shownUnit(name));

/** "10,000,000" */
export const grouped = (count: number) => count.toLocaleString(comma ? "de" : "en");

const written = (number: string) => (comma ? number.replace(".", ",") : number);

/** "12345", "0.0123", "4.51e-12": as commands write it (core/short_number.h), but for millions. */
export function short(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) {
    const [figures, power] = value.toExponential(digits - 1).split("e");
    return written(`${Number(figures)}e${Number(power)}`);
  }
  return written(String(Number(value.toPrecision(Math.max(digits, Math.ceil(Math.log10(size + 1)))))));
}

/** The same with the zeros at its end: numbers below each other then end at the same digit. */
export function full(value: number | null | undefined, digits = 3): string {
  const size = Math.abs(value ?? 0);
  return value === null || value === undefined || size < 1e-4 || size >= 1e4 ? short(value, digits) : written(value.toPrecision(Math.max(digits, Math.ceil(Math.log10(size + 1)))));
}

export function unitOf(units: Units, si: string): Unit {
  return inChosen(units[si] ?? { factor: 1, offset: 0, name: si });
}

/** Words in names of units, in German. */
const germanParts: [RegExp, string][] = [[/% of stroke/, "% des Wegs"], [/ per /g, " je "]];

/** Powers, roots and degrees as they are printed: "cm²", "l/min per √bar", "°C". */
export const printedUnit = (name: string) =>
  name.replace(/\bdegC\b/, "°C").replace(/sqrt\((\w+)\)/g, "√$1").replace(/(?<=[A-Za-z)])\^?2(?!\d)/g, "²").replace(/(?<=[A-Za-z)])\^?3(?!\d)/g, "³");

export function unitName(unit: { name: string }): string {
  if (unit.name === "1" || unit.name === "-") return "";
  const name = printedUnit(unit.name);
  return comma ? germanParts.reduce((text, [english, german]) => text.replace(english, german), name) : name;
}

/** "12202 ± 424", "(4.51 ± 0.03)e-12": the half width of the 95 % interval with two digits, the value with as many decimals; as
 * commands and alarms write it (core/interval_text.h). */
export function halfText(value: number, half: number | null): string {
  if (half === null || !Number.isFinite(half) || !(half > 0)) return short(value, 4);
  const exponent = Math.floor(Math.log10(Math.max(Math.abs(value), half)));
  const scale = exponent < -4 || exponent > 6 ? 10 ** exponent : 1, shown = value / scale, wide = half / scale;
  const decimals = Math.min(9, Math.max(0, 1 - Math.floor(Math.log10(Math.max(wide, 1e-4 * Math.abs(shown))))));
  const fixed = (number: number) => { const text = number.toFixed(decimals); return Number(text) === 0 ? (0).toFixed(decimals) : text; };
  const numbers = `${written(fixed(shown))}${tie}±${tie}${written(Number(fixed(wide)) === 0 ? wide.toExponential(0) : fixed(wide))}`;
  return scale === 1 ? numbers : `(${numbers})e${exponent}`;
}

/** "12202 ± 424 bar" */
export function withInterval(parameter: Parameter, units: Units): string {
  const unit = unitOf(units, parameter.unit);
  return withUnit(halfText(parameter.value * unit.factor + unit.offset, parameter.std === null ? null : 1.96 * parameter.std * unit.factor), unitName(unit));
}
