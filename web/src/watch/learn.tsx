import { useEffect, useState } from "preact/hooks";
import { find } from "../api";
import { Problem, useAttempt } from "../failure";
import { byFinger } from "../pointer";
import { useStore, work } from "../store";
import { useTyped } from "../typed";
import { useUrl } from "../url_state";
import { WholeNumber } from "../whole_number";
import { Told } from "../told";
import { useWords } from "../words";
import { dateText, isDate, symbolOf } from "./shown";
import { placeOf } from "./trend_axis";
import { TrendPlot } from "./trend_plot";
import { useTrends } from "./trends";
import { refreshWatch, useWatch } from "./watch_store";
import type { Learning, Overview } from "./watch_types";

/** Strokes of the healthy machine are chosen on the trend and become what drift is judged against. */
export function Learn({ overview }: { overview: Overview }) {
  const say = useWords();
  const [query, setUrl] = useUrl();
  const { session } = useStore();
  const { tick } = useWatch();
  const machine = overview.machines.find((m) => m.machine === query.machine) ?? overview.machines[0];
  const known = (machine?.parameters ?? []).filter((p) => p.trend);
  const parameter = known.find((p) => p.parameter === (query.p ?? "").split(",")[0]) ?? known[0];
  const strokes = machine?.strokes ?? 0;
  const whole = (text: string | undefined, otherwise: number) => (text && /^\d+$/.test(text) ? Number(text) : otherwise);
  const to = Math.min(strokes, Math.max(1, whole(query.to, strokes))), from = Math.max(0, Math.min(whole(query.from, 0), to - 1));
  const { trends, problem, ahead } = useTrends(machine?.machine ?? "", parameter ? [parameter.parameter] : [], from, to, strokes, tick);
  if (!machine || !parameter || strokes === 0) return <p class="empty" role="status">{say("noMachines")}</p>;
  const look = (first: number, end: number) => {
    const a = Math.max(0, Math.min(first, strokes - 2)), b = Math.min(strokes, Math.max(end, a + 2));
    setUrl({ from: a === 0 ? "" : String(a), to: b === strokes ? "" : String(b) });
  };
  const trend = trends[0], axis = machine.dated ? "time" : "stroke";
  const references = (trend?.marks ?? []).filter((mark) => mark.kind === "reference");
  return (
    <section class="learn">
      <h1>{say("learnTitle")}</h1>
      <p>{say("learnText")}</p>
      <div class="filters">
        {overview.machines.length > 1 && <label>{say("alarm_axis")} <select value={machine.machine} onChange={(e) => setUrl({ machine: e.currentTarget.value, from: "", to: "" })}>
          {overview.machines.map((m) => <option key={m.machine} value={m.machine}>{m.machine}</option>)}
        </select></label>}
        <label>{say("parameter")} <select value={parameter.parameter} onChange={(e) => setUrl({ p: e.currentTarget.value })}>
          {known.map((p) => <option key={p.parameter} value={p.parameter}>{symbolOf(p.unit)}</option>)}
        </select></label>
        <label>{say("learnFirst")} <WholeNumber name="learn-first" min={0} max={to - 1} value={from} take={(first) => look(first, to)} /></label>
        <label>{say("learnLast")} <WholeNumber name="learn-last" min={from} max={strokes - 1} value={to - 1} take={(last) => look(from, last + 1)} /></label>
        <button onClick={() => look(0, strokes)} disabled={to - from === strokes}>{say("everything")}</button>
      </div>
      <Problem of={overview.problem ? null : problem} />
      <div class="plots">{trend && <TrendPlot trend={trend} unit={parameter.unit} axis={axis} compensated={false} from={from} to={to} look={look} ahead={ahead} height={260} />}</div>
      <p class="quiet">{trend && isDate(trend.bins.begin_s[0]) && <>{dateText(placeOf(from, trend, "time"))} – {dateText(placeOf(to - 1, trend, "time"))} · </>}{say(byFinger() ? "learnFingers" : "trendKeys")}</p>
      {session?.changes ? <LearnForm key={machine.machine} machine={machine.machine} from={from} to={to} asksWho={!session.login} user={overview.user} />
        : <p class="empty">{session?.user ? say("onlyViewLearn") : say("loginToAct")}</p>}
      {references.length > 0 && <section class="marks"><h2>{say("learnedSoFar")}</h2><ul>
        {references.map((mark) => <li key={mark.stroke + mark.name}>{mark.name && <><Told of={mark} what="name" /> · </>}{say("strokeNumber", { stroke: mark.stroke })}{mark.text && <small> · <Told of={mark} what="text" /></small>}</li>)}
      </ul></section>}
    </section>
  );
}

/** First what speaks against these strokes, then learning them. */
function LearnForm({ machine, from, to, asksWho, user }: { machine: string; from: number; to: number; asksWho: boolean; user: string }) {
  const say = useWords();
  const [looked, setLooked] = useState<Learning | null>(null);
  const { busy, problem, attempt } = useAttempt();
  const [insist, setInsist] = useState(false);
  const [comment, setComment] = useTyped(`learn comment ${machine}`);
  const [who, setWho] = useState(localStorage.getItem("who") ?? user);
  useEffect(() => { setLooked(null); setInsist(false); }, [from, to]);
  const ask = (only_look: boolean) => attempt(async () => {
    await work("learn", { machine, first: from, last: to - 1, only_look, insist, comment, user: who }, "watch/learning");
    setLooked((await find<{ learning: Learning | null }>("watch/learning", { machine }))?.learning ?? null);
    if (only_look) return;
    setComment("");
    await refreshWatch(true);
  });
  const here = looked !== null && looked.first === from && looked.last === to - 1 ? looked : null;
  const may = here !== null && here.learned === null && (!here.refused || (insist && comment.trim() !== ""));
  return (
    <div class="act">
      <div class="buttons"><button class={here ? "" : "primary"} name="look" disabled={busy} onClick={() => void ask(true)}>{say("learnLook", { from, to: to - 1 })}</button></div>
      {busy && <p role="status" class="busy">{say("learnBusy")}</p>}
      {here && <div data-doubts={here.doubts.length} data-refused={here.refused ? "1" : "0"} data-learned={here.learned?.reference_version} role="status"
        class={here.learned || here.doubts.length === 0 ? "verdict good" : "verdict bad"}>
        {here.learned ? say("learned", { version: here.learned.reference_version, from: here.first, to: here.last })
          : here.doubts.length === 0 ? say("learnNothingAgainst") : say(here.refused ? "learnRefused" : "learnDoubts")}
        {here.doubts.length > 0 && <ul>{here.doubts.map((doubt) => <li key={doubt.text}><Told of={{ text: doubt.text, german: { text: doubt.german } }} what="text" /></li>)}</ul>}
      </div>}
      {here && !here.learned && <>
        {here.refused && <label class="tick-box"><input type="checkbox" name="insist" checked={insist} onChange={(e) => setInsist(e.currentTarget.checked)} /> {say("learnInsist")}</label>}
        {asksWho && <label>{say("who")} <input name="who" value={who} maxLength={100} onInput={(e) => setWho(e.currentTarget.value)} /></label>}
        <label>{say("learnWhy")} <textarea name="learn-comment" rows={2} maxLength={2000} value={comment} onInput={(e) => setComment(e.currentTarget.value)} /></label>
        <div class="buttons"><button class="primary" name="learn" disabled={busy || !may} onClick={() => void ask(false)}>{say("learnButton")}</button></div>
      </>}
      <Problem of={problem} />
    </div>
  );
}
