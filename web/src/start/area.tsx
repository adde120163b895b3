import { useState } from "preact/hooks";
import type { Proposal } from "../types";
import { short } from "../units";
import { useWords } from "../words";

/** Area of a piston, asked for as drawings give it: bore and rod. */
export function Area({ known, set }: { known: Proposal["geometry"][number]; set: (value: number | null) => void }) {
  const say = useWords();
  const [bore, setBore] = useState(known.value ? short(2000 * Math.sqrt(known.value / Math.PI), 5) : "");
  const [rod, setRod] = useState("0");
  const tell = (boreText: string, rodText: string) => {
    const b = Number(boreText.replace(",", ".")) / 1000, r = Number(rodText.replace(",", ".")) / 1000;
    const area = (Math.PI / 4) * (b * b - r * r);
    set(area > 0 ? area : null);
  };
  return (
    <fieldset class="area">
      <legend>{say("mapArea")} {known.name}</legend>
      <p>{say("mapAreaText")}</p>
      <label>{say("mapBore")} <input inputMode="decimal" name={`${known.name}-bore`} value={bore}
        onInput={(e) => { setBore(e.currentTarget.value); tell(e.currentTarget.value, rod); }} /></label>
      <label>{say("mapRod")} <input inputMode="decimal" name={`${known.name}-rod`} value={rod}
        onInput={(e) => { setRod(e.currentTarget.value); tell(bore, e.currentTarget.value); }} /></label>
      <output>{known.value !== null && say("mapAreaIs", { area: short(known.value * 1e4, 4) })}</output>
    </fieldset>
  );
}
