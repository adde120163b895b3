import { Told, useTold } from "../told";
import { useWords } from "../words";
import type { ProposalWork } from "./proposal";
import { isOdd, sizeText } from "./sizes";

const fewMissing = 4;  // that are named; of more their number is told

/** What is wrong, without its place in the file and the mark under it, which stand where one writes. */
const inShort = (text: string) => text.split("\n")[0].replace(/^\[[\w.]+\] /, "");

/** Whether the machine file can be used, what is missing until then, and the way on. */
export function Readiness({ first }: { first: ProposalWork }) {
  const say = useWords(), tell = useTold();
  const proposal = first.proposal!;
  const missing = [...proposal.pins.filter((pin) => pin.required && !pin.column).map((pin) => ({ ...pin, name: pin.signal })),
    ...proposal.geometry.filter((known) => known.required && known.value === null)];
  const odd = proposal.geometry.find((known) => isOdd(known, known.value));
  return (
    <>
      {first.inPart ? <p class="verdict bad" role="status">{say("ownInPart")}</p> : <p class={proposal.problem || odd ? "verdict bad" : "verdict good"} role="status">
        {odd ? say("mapOdd", { what: odd.name, from: sizeText(odd, odd.lowest), to: sizeText(odd, odd.highest) })
          : !proposal.problem ? say("mapReady")
          : missing.length > 0 ? say("mapNeeds", { what: missing.slice(0, fewMissing).map((what) => `${what.name} (${tell(what, "meaning").text})`).join(", ") + (missing.length > fewMissing ? say("mapNeedsMore", { count: missing.length - fewMissing }) : "") })
          : proposal.balance?.output === "" ? say("balanceNeeded")
          : <>{say("mapNotReady")}<Told of={{ error: inShort(proposal.problem.error), german: proposal.problem.german && { error: inShort(proposal.problem.german.error ?? "") } }} what="error" /></>}
      </p>}
      <button class="primary" disabled={proposal.problem !== null || odd !== undefined || !first.settled} onClick={() => void first.accept()}>{say("mapGo")}</button>
    </>
  );
}
