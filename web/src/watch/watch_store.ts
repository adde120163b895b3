// What the page knows of the database that is watched.

import { useEffect, useState } from "preact/hooks";
import { find, get } from "../api";
import { knowEffects } from "../effect_titles";
import { hear } from "../store";
import type { Alarm, Overview } from "./watch_types";

interface State {
  overview: Overview | null;
  alarms: Alarm[];
  /** Grows with every change of the database, and when a long trend became exact. */
  tick: number;
}

let state: State = { overview: null, alarms: [], tick: 0 };
const listeners = new Set<() => void>();

function set(change: Partial<State>) {
  state = { ...state, ...change };
  for (const listener of listeners) listener();
}

/** `changed`: the program said so; else a look now and then, which redraws nothing where nothing changed. */
export async function refreshWatch(changed = false): Promise<void> {
  const overview = await find<Overview>("watch/overview");
  if (!overview) return;  // being read: an event tells when it was
  knowEffects(overview.effects ?? []);
  const { alarms } = await get<{ alarms: Alarm[] }>("watch/alarms");
  if (!changed && JSON.stringify([overview, alarms]) === JSON.stringify([state.overview, state.alarms])) return;
  set({ overview, alarms, tick: state.tick + 1 });
}

hear((event) => {
  if (event.state === "watched" || event.state === "connected") void refreshWatch(true).catch(() => {});
  if (event.state === "trend") set({ tick: state.tick + 1 });
});

export function useWatch(): State {
  const [, redraw] = useState(0);
  useEffect(() => {
    const listener = () => redraw((n) => n + 1);
    listeners.add(listener);
    return () => void listeners.delete(listener);
  }, []);
  return state;
}
