import { useEffect, useRef, useState } from "preact/hooks";
import type { KnownSize } from "../types";
import { Told } from "../told";
import { inChosen, short, unitName, withUnit } from "../units";
import { useWords } from "../words";

/** What a machine has to be known by, and what may be known of it, as data sheets give it. */
export function Sizes({ sizes, set }: { sizes: KnownSize[]; set: (name: string, value: number | null) => void }) {
  const say = useWords();
  const [required, others] = [sizes.filter((size) => size.required), sizes.filter((size) => !size.required)];
  const rows = (some: KnownSize[]) => <div class="sizes">{some.map((size) => <Size key={size.name} size={size} set={(value) => set(size.name, value)} />)}</div>;
  return (
    <>
      {required.length > 0 && <fieldset><legend>{say("mapSizes")}</legend><p class="quiet">{say("mapSizesText")}</p>{rows(required)}</fieldset>}
      {others.length > 0 && <details><summary>{say("mapOther")}</summary>{rows(others)}</details>}
    </>
  );
}

/** Whether no machine has it so large or small. */
export function isOdd(size: KnownSize, value: number | null): boolean {
  return value !== null && size.lowest < size.highest && (value < size.lowest || value > size.highest);
}

/** A value (SI) in the unit in which it is asked for. */
export function sizeText(size: KnownSize, si: number): string {
  const unit = inChosen(size.unit);
  return withUnit(short(si * unit.factor + unit.offset), unitName(unit));
}

function Size({ size, set }: { size: KnownSize; set: (value: number | null) => void }) {
  const unit = inChosen(size.unit), shown = (si: number) => short(si * unit.factor + unit.offset, 6);
  const [text, setText] = useState(size.value === null ? "" : shown(size.value));
  const before = useRef(unit.factor);
  useEffect(() => {  // what was typed means the same in another unit
    if (before.current !== unit.factor && size.value !== null) setText(shown(size.value));
    before.current = unit.factor;
  }, [unit.factor]);
  const said = text.trim() === "" ? null : (Number(text.replace(",", ".")) - unit.offset) / unit.factor;
  const wrong = said !== null && (!Number.isFinite(said) || isOdd(size, said));
  const write = (next: string) => {
    setText(next);
    const value = next.trim() === "" ? null : (Number(next.replace(",", ".")) - unit.offset) / unit.factor;
    if (value === null || Number.isFinite(value)) set(value);
  };
  return (
    <label class={size.required && said === null ? "size missing" : "size"}>
      <span><strong>{size.name}</strong> <Told of={size} what="meaning" /></span>
      <span class="entry"><input inputMode="decimal" name={`size-${size.name}`} value={text} placeholder={size.otherwise === null ? "" : shown(size.otherwise)}
        aria-invalid={wrong ? "true" : undefined} onInput={(e) => write(e.currentTarget.value)} /> {unitName(unit)}</span>
    </label>
  );
}
