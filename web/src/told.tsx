// Sentences of the engine. It tells them in English, and beside it in German as far as there is German; the page shows what is told
// in its language and says of the rest that it is English.

import { useContext } from "preact/hooks";
import { isEffect, titleOf, withTitles } from "./effect_titles";
import { kept } from "./units";
import { LanguageContext, sayIn, type Language } from "./words";
import type { Words } from "./words/en";

/** Something with sentences under these keys, and the same in German. */
export type Telling<K extends string> = Record<K, string> & { german?: Partial<Record<K, string>> | null };

export type Tell = <K extends string>(of: Telling<K>, what: K) => { text: string; lang?: "en" };

/** Commands that sentences lead to, by what the page calls the same of its own. */
const places: Record<string, keyof Words> = {
  check: "step_check", compare: "step_compare", explain: "verdictTitle", frf: "valveTab", "model remove": "step_add",
  trends: "view_trends", alarms: "view_alarms", learn: "view_learn", status: "view_service", "check --live": "view_service",
};
const command = /['`]hydroscope ((?:check --live|model remove|\w+))(?: --from --to)?['`]/g;

function withPlaces(sentence: string, language: Language): string {
  const say = sayIn(language), [open, close] = language === "de" ? ["„", "“"] : ["“", "”"];
  return sentence.replace(command, (written, name: string) => (places[name] ? `${open}${say(places[name])}${close}` : written));
}

/** As people print it: a terminal has no arrows and no degrees. */
const printed = (sentence: string, language: Language) => kept(withPlaces(withTitles(sentence, language), language)
  .replace(/ -> /g, " → ").replace(/sqrt\((bar|Pa)\)/g, "√$1").replace(/\bdegC\b/g, "°C").replace(/(?<=\d m)[23](?=\/)|(?<=\bm)3(?=\/s\b)|(?<=\b[cm]m)[23]\b/g, (power) => (power === "2" ? "²" : "³")));

/** A sentence, with the language to say of it where it is not that of the page. */
export function useTold(): Tell {
  const language = useContext(LanguageContext);
  return (of, what) => {
    if (isEffect(of[what])) return { text: titleOf(of[what], language) };
    const german = of.german?.[what];
    if (language === "de" && german) return { text: printed(german, "de") };
    const text = printed(of[what], language);
    return language === "en" ? { text } : { text, lang: "en" };
  };
}

/** Sentences that stand in a list, and the same in German in the same order. */
export function ToldList({ of, german }: { of: string[]; german?: string[] }) {
  return <>{of.map((text, k) => <li key={text}><Told of={{ text, german: { text: german?.[k] } }} what="text" /></li>)}</>;
}

export function Told<K extends string>({ of, what }: { of: Telling<K>; what: K }) {
  const { text, lang } = useTold()(of, what);
  return <span lang={lang}>{text}</span>;
}
