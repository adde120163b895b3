import { useEffect, useRef } from "preact/hooks";
import { quantities, unitChoices, type ChosenUnits } from "./units";
import { useWords } from "./words";

/** In which units numbers are shown; kept on this computer. */
export function UnitMenu({ units, choose }: { units: ChosenUnits; choose: (units: ChosenUnits) => void }) {
  const say = useWords();
  const menu = useRef<HTMLDetailsElement>(null);
  useEffect(() => {  // over what is looked at next it would lie in the way
    const close = () => { if (menu.current) menu.current.open = false; };
    addEventListener("hashchange", close);
    return () => removeEventListener("hashchange", close);
  }, []);
  return (
    <details ref={menu} class="unit-menu" onKeyDown={(e) => { if (e.key === "Escape") e.currentTarget.open = false; }}
      onFocusOut={(e) => { if (!e.currentTarget.contains(e.relatedTarget as Node | null)) e.currentTarget.open = false; }}>
      <summary>{say("units")}</summary>
      <div>
        {quantities.map((quantity) => (
          <label key={quantity}>{say(`unit_${quantity}`)}{" "}
            <select name={`unit-${quantity}`} value={units[quantity]} onChange={(e) => choose({ ...units, [quantity]: e.currentTarget.value })}>
              {Object.keys(unitChoices[quantity]).map((name) => <option key={name} value={name}>{name}</option>)}
            </select></label>
        ))}
        <small>{say("unitsText")}</small>
      </div>
    </details>
  );
}
