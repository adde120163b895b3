import { useEffect, useMemo } from "preact/hooks";
import { Problem } from "../failure";
import { useStore } from "../store";
import { useUrl } from "../url_state";
import { inChosen, unitsKey } from "../units";
import { CountedIn, useWords } from "../words";
import { Alarms } from "./alarms";
import { OverviewPage } from "./overview";
import { Trends } from "./trends";
import { Learn } from "./learn";
import { Service } from "./service";
import { Scada } from "./scada";
import { Valve } from "./valve";
import { refreshWatch, useWatch } from "./watch_store";
import type { Overview } from "./watch_types";

export const views = ["overview", "trends", "alarms", "valve", "learn", "scada", "service", "workbench", "audit", "login"] as const;
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

/** Parameters in the units that people chose. */
function useChosenUnits(overview: Overview | null): Overview | null {
  return useMemo(() => overview && { ...overview, machines: overview.machines?.map((machine) => ({ ...machine,
    parameters: machine.parameters.map((parameter) => ({ ...parameter, unit: inChosen(parameter.unit) })) })) }, [overview, unitsKey()]);
}

/** A database: what is known of its machines, each view of it. */
export function Watch({ view }: { view: View }) {
  const say = useWords();
  const overview = useChosenUnits(useWatch().overview);
  useEffect(() => {
    void refreshWatch().catch(() => {});
    const again = setInterval(() => void refreshWatch().catch(() => {}), 30_000);  // the program rests while nobody asks
    return () => clearInterval(again);
  }, []);
  const [query] = useUrl();
  if (!overview) return <p class="empty" role="status">{say("loading")}</p>;
  const looked_at = overview.machines?.find((machine) => machine.machine === query.machine) ?? overview.machines?.[0];
  return (
    <CountedIn of={looked_at?.counted}><div class="watch">
      <Problem of={overview.problem} before={`${say("watchProblem")} `} />
      {!overview.machines ? null
        : view === "trends" ? <Trends overview={overview} />
        : view === "alarms" ? <Alarms overview={overview} />
        : view === "valve" ? <Valve overview={overview} />
        : view === "learn" ? <Learn overview={overview} />
        : view === "scada" ? <Scada />
        : view === "service" ? <Service overview={overview} />
        : <OverviewPage overview={overview} />}
    </div></CountedIn>
  );
}
