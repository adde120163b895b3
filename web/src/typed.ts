// What a person types is kept for this tab until it is sent: neither a restart of the program nor loading anew takes it away.

import { useState } from "preact/hooks";

/** As if a person had typed it. */
export const type = (name: string, text: string): void => sessionStorage.setItem(`typed ${name}`, text);

export const forgetTyped = (name: string): void => sessionStorage.removeItem(`typed ${name}`);

/** Text of a field that is called `name`, and how it is changed; "" where nothing is typed begins with `first`. */
export function useTyped(name: string, first = ""): [string, (text: string) => void] {
  const key = `typed ${name}`;
  const [text, setText] = useState(() => sessionStorage.getItem(key) ?? first);
  const change = (next: string) => {
    setText(next);
    if (next === first) sessionStorage.removeItem(key); else sessionStorage.setItem(key, next);
  };
  return [text, change];
}
