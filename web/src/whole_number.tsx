import { useState } from "preact/hooks";

/** A field for a whole number. What is being typed stays until it is done (Enter, Tab, a click elsewhere), whatever is drawn anew. */
export function WholeNumber({ name, value, min, max, take }: { name: string; value: number; min: number; max: number; take: (value: number) => void }) {
  const [typed, setTyped] = useState<string | null>(null);
  const done = (text: string) => {
    setTyped(null);
    if (/^\d+$/.test(text)) take(Number(text));
  };
  return <input type="number" name={name} min={min} max={max} value={typed ?? value} onInput={(e) => setTyped(e.currentTarget.value)}
    onChange={(e) => done(e.currentTarget.value)} />;
}
