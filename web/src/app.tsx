import { useEffect, useMemo, useState } from "preact/hooks";
import { post } from "./api";
import { Audit } from "./access/audit";
import { Account, Login } from "./access/login";
import { Start } from "./start/start";
import { FirstRun } from "./start/mapping";
import { OwnMachine } from "./start/own_machine";
import { ownTyped } from "./start/proposal";
import { refresh, useStore } from "./store";
import { applyTheme, firstTheme, type Theme } from "./theme";
import { forgetTyped } from "./typed";
import { UnitMenu } from "./unit_menu";
import { firstUnits, showUnitsIn, writeNumbersIn, type ChosenUnits } from "./units";
import { useUrl } from "./url_state";
import { Watch, WatchNavigation, views, type View } from "./watch/watch";
import { Workbench } from "./workbench/workbench";
import type { Words } from "./words/en";
import { CountedIn, firstLanguage, LanguageContext, sayIn, useWords, WordsContext, type Language } from "./words";

/** Where one is: only a database has more to look at than the workbench. */
function useView(): View {
  const [query] = useUrl();
  const { session } = useStore();
  if (!session?.watched) return "workbench";
  return views.find((view) => view === query.view) ?? "overview";
}

interface Looks { language: Language; setLanguage: (l: Language) => void; units: ChosenUnits; setUnits: (u: ChosenUnits) => void }

function Header({ language, setLanguage, units, setUnits }: Looks) {
  const say = useWords();
  const { session } = useStore();
  const view = useView();
  const [theme, setTheme] = useState<Theme>(firstTheme);
  useEffect(() => applyTheme(theme), [theme]);
  const begun = session !== null && (session.logs.length > 0 || session.machine !== null);
  const startOver = async () => {
    if (!confirm(say("startOverSure"))) return;
    await post("start_over");
    location.hash = "";
    forgetTyped(ownTyped);
    await refresh();
  };
  return (
    <header class="top">
      <span class="brand">{say("title")}</span>
      {view === "workbench" && session?.machine && <span class="what">{session.machine.name}{session.logs.length > 0 && ` · ${session.logs.map((l) => l.name.split("/").pop()).join(", ")}`}
        {session.unsaved && <em> · {say("unsaved")}</em>}</span>}
      {session?.watched && <WatchNavigation view={view} />}
      <span class="spring" />
      {begun && view === "workbench" && <button class="quiet start-over" onClick={startOver}>{say("startOver")}</button>}
      <Account />
      <UnitMenu units={units} choose={setUnits} />
      <select aria-label={say("theme")} value={theme} onChange={(e) => setTheme(e.currentTarget.value as Theme)}>
        <option value="auto">{say("themeAuto")}</option>
        <option value="light">{say("themeLight")}</option>
        <option value="dark">{say("themeDark")}</option>
      </select>
      <select aria-label={say("language")} value={language} onChange={(e) => setLanguage(e.currentTarget.value as Language)}>
        <option value="en">EN</option>
        <option value="de">DE</option>
      </select>
    </header>
  );
}

/** What the program works on at this moment. */
function Working() {
  const say = useWords();
  const { jobs } = useStore();
  const running = Object.values(jobs).find((job) => job.state === "running");
  return (
    <div class="working" role="status">
      {running && <>{say(`work_${running.kind}` as keyof Words)}{running.share ? <progress max={1} value={running.share} aria-label={say(`work_${running.kind}` as keyof Words)} /> : null}</>}
    </div>
  );
}

export function App() {
  const [language, setLanguage] = useState(firstLanguage);
  const [units, setUnits] = useState(firstUnits);
  const { session, connected, locked } = useStore();
  const view = useView();
  const [{ step, effect, page }] = useUrl();
  const say = useMemo(() => sayIn(language), [language]);
  writeNumbersIn(language);
  showUnitsIn(units);
  useEffect(() => localStorage.setItem("units", JSON.stringify(units)), [units]);
  useEffect(() => {
    localStorage.setItem("language", language);
    document.documentElement.lang = language;
  }, [language]);
  useEffect(() => scrollTo(0, 0), [view, step, effect, page]);  // what is looked at now begins at the top
  return (
    <LanguageContext.Provider value={language}><WordsContext.Provider value={say}>
      <Header {...{ language, setLanguage, units, setUnits }} />
      {!connected && !locked && <p class="lost" role="alert">{say("lost")}</p>}
      {locked && <main><Login /></main>}
      <main hidden={locked}>
        {session === null ? <p class="empty">{say("loading")}</p>
          : view === "login" ? <Login />
          : view === "audit" ? <Audit />
          : view !== "workbench" ? <Watch view={view} />
          : session.logs.length === 0 ? (page === "own" && session.changes ? <OwnMachine first={null} /> : <Start />)
          : session.machine === null ? <FirstRun />
          : <CountedIn of={session.machine.counted}><Workbench session={session} /></CountedIn>}
      </main>
      <Working />
    </WordsContext.Provider></LanguageContext.Provider>
  );
}
