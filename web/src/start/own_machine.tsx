import { useEffect, useRef } from "preact/hooks";
import { Problem } from "../failure";
import { useUrl } from "../url_state";
import { useWords } from "../words";
import { BalanceEditor } from "./balance";
import { Columns } from "./columns";
import { GateOfLog } from "./gate_plot";
import { PinRow } from "./mapping";
import type { ProposalWork } from "./proposal";
import { Readiness } from "./readiness";
import { DropLogs } from "./start";

/** Puts a name where somebody wrote last. */
function insertInto(field: HTMLInputElement | null, name: string) {
  if (!field?.isConnected) return;
  field.focus();
  field.setRangeText(name, field.selectionStart ?? field.value.length, field.selectionEnd ?? field.value.length, "end");
  field.dispatchEvent(new Event("input", { bubbles: true }));
}

/** The page of a machine of one's own: columns and units, balance and effects, gate, and whether it can be used. */
export function OwnMachine({ first }: { first: ProposalWork | null }) {
  const say = useWords();
  const [, setUrl] = useUrl();
  const wrote = useRef<HTMLInputElement | null>(null);
  const proposal = first?.proposal ?? null, own = proposal?.balance != null && !first?.awaited;
  const kind = proposal?.kinds.find((known) => known.own)?.id;
  useEffect(() => {
    if (!first || !kind || first.awaited || (own && first.chosen)) return;
    if (own) first.keepKind(); else void first.takeKind(kind);
  }, [proposal?.model]);
  return (
    <section class="mapping own-machine" onFocusIn={(e) => { if ((e.target as Element).matches("input.expression")) wrote.current = e.target as HTMLInputElement; }}>
      <button class="quiet" onClick={() => setUrl({ page: "" })}>‹ {say(first ? "ownMachineColumns" : "ownMachineStart")}</button>
      <h1>{say("ownMachineTitle")}</h1>
      <p>{say("ownMachineText")}</p>
      <div class="two">
        <div>
          {!first ? <DropLogs text={say("ownMachineDrop")} />
            : !own ? <p class="empty" role="status">{say("loading")}</p>
            : <>
              <h2>{say("mapColumns")}</h2>
              <p class="quiet">{say("ownInsertText")}</p>
              <Columns proposal={proposal!} insert={(signal) => insertInto(wrote.current, signal)} />
              <h2>{say("ownUnits")}</h2>
              <ul class="pins">{proposal!.pins.map((pin) => <PinRow key={pin.signal} pin={pin} proposal={proposal!} put={first.put} />)}</ul>
            </>}
        </div>
        <div>
          {(!first || own) && <BalanceEditor key={own ? "log" : "none"} proposal={own ? proposal : null} picture={first?.picture ?? null}
            write={(whole) => first?.write(whole)} set={(written) => void first!.propose({ model: proposal!.model, ...written })} />}
        </div>
      </div>
      {first && own && <>
        <GateOfLog first={first} />
        <Problem of={first.problem} />
        <details><summary>{say("mapFileText")}</summary><pre tabIndex={0}>{proposal!.text}</pre></details>
        <Readiness first={first} />
      </>}
    </section>
  );
}
