// Sentences of the engine. It tells them in English, and beside it in German as far as there is German; the page shows what is told
// in its language and says of the rest that it is English.

import { useContext } from "preact/hooks";
import { isEffect, titleOf, withTitles } from "./effect_titles";
import { kept } from "./units";
import { LanguageContext, type Language } from "./words";

/** Something with sentences under these keys, and the same in German. */
export type Telling<K extends string> = Record<K, string> & { german?: Partial<Record<K, string>> | null };

export type Tell = <K extends string>(of: Telling<K>, what: K) => { text: string; lang?: "en" };

/** As people print it: a terminal has no arrows. */
const printed = (sentence: string, language: Language) => kept(withTitles(sentence, language).replace(/ -> /g, " → ").replace(/(?<=\d m)[23](?=\/)/g, (power) => (power === "2" ? "²" : "³")));

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
