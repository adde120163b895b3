import { Problem, useAttempt } from "../failure";
import { work } from "../store";
import type { Effect, ExplainResult } from "../types";
import { useTold } from "../told";
import { amount } from "../units";
import { useUrl } from "../url_state";
import { useWords } from "../words";

/** An effect of the model that another one explains better: told with both errors, and done by one button, as versions that stay. */
export function Swap({ swap, unit, effects }: { swap: NonNullable<ExplainResult["swap"]>; unit: string; effects: Effect[] }) {
  const say = useWords(), tell = useTold();
  const [, setUrl] = useUrl();
  const { busy, problem, attempt } = useAttempt();
  const title = (id: string) => { const known = effects.find((effect) => effect.id === id); return known?.title ? tell(known, "title").text : id; };
  const replace = () => attempt(async () => {
    await work("remove", { effect: swap.out });
    for (const effect of swap.in) await work("add", { effect });
    setUrl({ step: "confirm", effect: "" });
  });
  const values = { out: title(swap.out), in: swap.in.map(title).join(" + "), before: amount(swap.rms_holdout_before, unit), after: amount(swap.rms_holdout_after, unit) };
  return (
    <div class="suspect">
      <p>{say(swap.in.length > 0 ? "swap" : "swapOut", values)}</p>
      <button data-swap={swap.out} disabled={busy} onClick={() => void replace()}>{say(swap.in.length > 0 ? "swapButton" : "swapOutButton")}</button>
      <Problem of={problem} />
    </div>
  );
}
