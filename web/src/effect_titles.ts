// The program names effects by their ids, as machine files, the journal and SCADA have them; people read their titles.

import type { Language } from "./words";

export interface Titled { id: string; title: string; german?: { title: string } | null }

const known = new Map<string, Titled>();

export function knowEffects(effects: Titled[]): void {
  for (const effect of effects) if (effect.title) known.set(effect.id, effect);
}

export const isEffect = (text: string) => known.has(text);

/** The title of an effect; its id where it has none. */
export function titleOf(id: string, language: Language): string {
  const effect = known.get(id);
  return (language === "de" && effect?.german?.title) || effect?.title || id;
}

/** "Internal leakage past the piston seal: G" of "internal_leakage.G". */
export function parameterName(parameter: string, language: Language): string {
  const [effect, ...rest] = parameter.split(".");
  return known.has(effect) ? [titleOf(effect, language), ...rest].join(": ") : parameter;
}

const ids = /'?(?<![\w-])([a-z]+(?:_[a-z0-9]+)+)(?![\w=])'?/g;  // not what is part of a command, as --measured lag_p_A=0.1

const beside = / \(([a-z]+(?:_[a-z0-9]+)+)\)/g;  // "Orifice-like leakage from A to B (orifice_leakage)"

/** A sentence with the titles of the effects that it names. */
export function withTitles(sentence: string, language: Language): string {
  const [open, close] = language === "de" ? ["„", "“"] : ["“", "”"];
  return sentence
    .replace(beside, (written, id: string, at: number) => (known.has(id) && sentence.slice(0, at).endsWith(titleOf(id, language)) ? "" : written))
    .replace(ids, (written, id: string) => (known.has(id) ? `${open}${titleOf(id, language)}${close}` : written));
}
