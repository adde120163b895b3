// The words of the page in the language chosen. What the engine says is told by told.tsx.

import { createContext, createElement, type ComponentChildren } from "preact";
import { useContext, useMemo } from "preact/hooks";
import { kept } from "./units";
import { de } from "./words/de";
import { en, type Words } from "./words/en";

export type Language = "en" | "de";
export type Say = (key: keyof Words, values?: Record<string, string | number>) => string;

export function firstLanguage(): Language {
  const kept = localStorage.getItem("language");
  if (kept === "en" || kept === "de") return kept;
  return navigator.language.startsWith("de") ? "de" : "en";
}

/** The one that the page is shown in. */
export const pageLanguage = (): Language => (document.documentElement.lang === "de" ? "de" : "en");

/** What a machine repeats and is judged by. Words that depend on it are written "<stroke|episode>"; those that also depend on the
 * number before them "{count} <stroke/strokes|episode/episodes>" or "{count} open <file/files>". */
export type Counted = "stroke" | "episode";

export function sayIn(language: Language, counted: Counted = "stroke"): Say {
  const words = language === "de" ? de : en;
  const chosen = (written: string) => {
    const [stroke, episode = stroke] = written.split("|");
    return counted === "episode" ? episode : stroke;
  };
  return (key, values = {}) => kept((words[key] ?? String(key).replace(/^[a-z]+_/, "").replace(/_/g, " "))
    .replace(/\{(\w+)\}( [^{}<>]*)<([^>]*\/[^>]*)>/g, (_, name: string, between: string, written: string) => {
      const [one, many] = chosen(written).split("/");
      return `${values[name] ?? ""}${between}${String(values[name]) === "1" ? one : many}`;
    })
    .replace(/<([^|>]*\|[^>]*)>/g, (_, written: string) => chosen(written))
    .replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? "")));
}

export const WordsContext = createContext<Say>(sayIn("en"));
export const LanguageContext = createContext<Language>("en");
export const useWords = () => useContext(WordsContext);

/** Inside, the words are those of a machine that counts in `of`. */
export function CountedIn({ of, children }: { of: Counted | undefined; children: ComponentChildren }) {
  const language = useContext(LanguageContext);
  const say = useMemo(() => sayIn(language, of), [language, of]);
  return createElement(WordsContext.Provider, { value: say, children });
}
