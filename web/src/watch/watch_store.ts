// What the page knows of the database that is watched.

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
