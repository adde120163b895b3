// What the page knows of the database that is watched.

import { useEffect, useState } from "preact/hooks";
import { find, get } from "../api";
import { knowEffects } from "../effect_titles";
import { Outside } from "../outside";
import { hear } from "../store";
import type { Alarm, Overview } from "./watch_types";

interface State {
  overview: Overview | null;
  alarms: Alarm[];
  /** Grows with every change of the database, and when a long trend became exact. */
  tick: number;
}

const store = new Outside<State>({ overview: null, alarms: [], tick: 0 });

/** `changed`: the program said so; else a look now and then, which redraws nothing where nothing changed. */
export async function refreshWatch(changed = false): Promise<void> {
  const overview = await find<Overview>("watch/overview");
  if (!overview) return;  // being read: an event tells when it was
  knowEffects(overview.effects ?? []);
  const { alarms } = await get<{ alarms: Alarm[] }>("watch/alarms");
  if (!changed && JSON.stringify([overview, alarms]) === JSON.stringify([store.now.overview, store.now.alarms])) return;
  store.set({ overview, alarms, tick: store.now.tick + 1 });
}

hear((event) => {
  if (event.state === "watched" || event.state === "connected") void refreshWatch(true).catch(() => {});
  if (event.state === "trend") store.set({ tick: store.now.tick + 1 });
});

export const useWatch = (): State => store.use();

/** An answer about what is watched, asked for anew with each change and, with `every`, after so many ms: what no event tells of.
 * undefined: none came yet, null: there is none. What was answered stays until another answer comes. */
export function useAnswer<T>(path: string, query: Record<string, string | number> = {}, every?: number, asked = true): T | null | undefined {
  const { tick } = useWatch();
  const [answer, setAnswer] = useState<T | null | undefined>(undefined);
  const about = JSON.stringify([path, query]);
  useEffect(() => {
    if (!asked) return;
    let gone = false;
    const look = () => void find<T>(path, query).then((found) => { if (!gone) setAnswer(found); }).catch(() => { if (!gone) setAnswer((known) => known ?? null); });
    look();
    const again = every === undefined ? undefined : setInterval(look, every);
    return () => { gone = true; clearInterval(again); };
  }, [about, tick, every, asked]);
  return answer;
}
