import { useEffect, useRef, useState } from "preact/hooks";
import type { Proposal } from "../types";
import { Told } from "../told";
import { short, shownUnit } from "../units";
import { useWords } from "../words";

/** Area of a piston, asked for as drawings give it: bore and rod. */
export function Area({ known, set }: { known: Proposal["geometry"][number]; set: (value: number | null) => void }) {
  const say = useWords();
  const { factor, name } = shownUnit("mm");
  const [bore, setBore] = useState(known.value ? short(2000 * factor * Math.sqrt(known.value / Math.PI), 5) : "");
  const [rod, setRod] = useState("0");
  const before = useRef(factor);
  useEffect(() => {  // what was typed means the same in another unit
    const times = factor / before.current, again = (text: string) => (text.trim() === "" || times === 1 ? text : short(Number(text.replace(",", ".")) * times, 5));
    before.current = factor;
    setBore(again);
    setRod(again);
  }, [factor]);
  const tell = (boreText: string, rodText: string) => {
    const [b, r] = [boreText, rodText].map((text) => Number(text.replace(",", ".")) / factor / 1000);  // m
    const area = (Math.PI / 4) * (b * b - r * r);
    set(area > 0 ? area : null);
  };
  return (
    <fieldset class="area">
      <legend>{known.name} <Told of={known} what="meaning" /></legend>
      <p>{say("mapAreaText")}</p>
      <label>{say("mapBore")} ({name}) <input inputMode="decimal" name={`${known.name}-bore`} value={bore}
        onInput={(e) => { setBore(e.currentTarget.value); tell(e.currentTarget.value, rod); }} /></label>
      <label>{say("mapRod")} ({name}) <input inputMode="decimal" name={`${known.name}-rod`} value={rod}
        onInput={(e) => { setRod(e.currentTarget.value); tell(bore, e.currentTarget.value); }} /></label>
      <output>{known.value !== null && say("mapAreaIs", { area: short(known.value * 1e4, 4) })}</output>
    </fieldset>
  );
}
