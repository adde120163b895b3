import { useEffect } from "preact/hooks";
import { useStore } from "../store";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import { Alarms } from "./alarms";
import { OverviewPage } from "./overview";
import { Trends } from "./trends";
import { Scada } from "./scada";
import { Valve } from "./valve";
import { refreshWatch, useWatch } from "./watch_store";

export const views = ["overview", "trends", "alarms", "valve", "scada", "workbench", "audit", "login"] as const;
export type View = (typeof views)[number];

export function WatchNavigation({ view }: { view: View }) {
  const say = useWords();
  const [, setUrl] = useUrl();
  const { alarms } = useWatch();
  const { session } = useStore();
  const shown = (name: View) => name === "workbench" ? session?.workbench : name === "audit" ? session?.login && session.user?.role === "admin" : name !== "login";
  const standing = alarms.filter((alarm) => !alarm.at_rest).length;
  return (
    <nav class="views" aria-label={say("views")}>
      {views.filter(shown).map((name) => (
        <button key={name} aria-current={name === view ? "page" : undefined} onClick={() => setUrl({ view: name })}>
          {say(`view_${name}`)}{name === "alarms" && standing > 0 && <span class="count">{standing}</span>}
        </button>
      ))}
    </nav>
  );
}

/** A database: overview, trends, alarms, valve or SCADA. */
export function Watch({ view }: { view: View }) {
  const say = useWords();
  const { overview } = useWatch();
  useEffect(() => {
    void refreshWatch().catch(() => {});
    const again = setInterval(() => void refreshWatch().catch(() => {}), 30_000);  // the program rests while nobody asks
    return () => clearInterval(again);
  }, []);
  if (!overview) return <p class="empty" role="status">{say("loading")}</p>;
  return (
    <div class="watch">
      {overview.problem && <p class="problem" role="alert">{say("watchProblem")} <span lang="en">{overview.problem}</span></p>}
      {!overview.machines ? null
        : view === "trends" ? <Trends overview={overview} />
        : view === "alarms" ? <Alarms overview={overview} />
        : view === "valve" ? <Valve overview={overview} />
        : view === "scada" ? <Scada />
        : <OverviewPage overview={overview} />}
    </div>
  );
}
