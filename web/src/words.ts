// The words of the page in the language chosen. What the engine says is told by told.tsx.

import { createContext } from "preact";
import { useContext } from "preact/hooks";
import { de } from "./words/de";
import { en, type Words } from "./words/en";

export type Language = "en" | "de";
export type Say = (key: keyof Words, values?: Record<string, string | number>) => string;

export function firstLanguage(): Language {
  const kept = localStorage.getItem("language");
  if (kept === "en" || kept === "de") return kept;
  return navigator.language.startsWith("de") ? "de" : "en";
}

export function sayIn(language: Language): Say {
  const words = language === "de" ? de : en;
  return (key, values = {}) => words[key].replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ""));
}

export const WordsContext = createContext<Say>(sayIn("en"));
export const LanguageContext = createContext<Language>("en");
export const useWords = () => useContext(WordsContext);
