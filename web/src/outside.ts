// What changes outside of the components and is drawn by them.

import { useEffect, useState } from "preact/hooks";

/**
 * What stands outside now; drawn again with each change. `listen` begins to listen and gives back how to end it. A component
 * listens some frames after it was drawn for the first time: what changed until then is looked at once it does.
 */
export function useOutside<T>(now: () => T, listen: (changed: () => void) => () => void): T {
  const [seen, see] = useState<{ it: T }>({ it: now() });
  useEffect(() => {
    const changed = () => see((last) => (Object.is(last.it, now()) ? last : { it: now() }));
    const end = listen(changed);
    changed();
    return end;
  }, []);
  return seen.it;
}

/** A value with those who listen to it. */
export class Outside<T extends object> {
  private readonly listeners = new Set<() => void>();
  constructor(private value: T) {}
  get now(): T { return this.value; }
  set(change: Partial<T>): void {
    this.value = { ...this.value, ...change };
    for (const listener of this.listeners) listener();
  }
  use(): T {
    return useOutside(() => this.value, (changed) => {
      this.listeners.add(changed);
      return () => void this.listeners.delete(changed);
    });
  }
}
