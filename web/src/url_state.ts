// What is looked at stands in the address, so that it can be kept, sent and gone back from.

import { useMemo } from "preact/hooks";
import { useOutside } from "./outside";

type Query = Record<string, string>;

function read(): Query {
  return Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
}

/** The state of the address and a way to change it; "" takes a key away. */
export function useUrl(): [Query, (change: Query) => void] {
  const hash = useOutside(() => location.hash, (changed) => {
    addEventListener("hashchange", changed);
    return () => removeEventListener("hashchange", changed);
  });
  const query = useMemo(read, [hash]);
  const change = (values: Query) => {
    const next = { ...read(), ...values };
    for (const key of Object.keys(next)) if (next[key] === "") delete next[key];
    location.hash = new URLSearchParams(next).toString();
  };
  return [query, change];
}
