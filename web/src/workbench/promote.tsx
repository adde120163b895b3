import { useState } from "preact/hooks";
import { Problem, useAttempt } from "../failure";
import { work } from "../store";
import type { Session } from "../types";
import { useTyped } from "../typed";
import { amount } from "../units";
import { useWords } from "../words";
import { useModelName } from "./parts";
import { refreshWatch, useWatch } from "../watch/watch_store";

/** The model worked on becomes the one that the machine is watched with. */
export function Promote({ session }: { session: Session }) {
  const say = useWords();
  const { overview } = useWatch();
  const [comment, setComment] = useTyped("promote comment");
  const [told, setTold] = useState(false);
  const { busy, problem, attempt } = useAttempt();
  const current = session.versions.find((version) => version.current);
  const watched = overview?.machines?.find((machine) => machine.machine === session.strokes?.machine);
  const names = useModelName();
  const promote = () => attempt(async () => {
    await work("promote", { comment }, "promote");
    setComment("");
    setTold(true);
    await refreshWatch(true);
  });
  return (
    <section class="promote">
      <h1>{say("promoteTitle")}</h1>
      {!session.strokes ? <p class="empty">{session.watched ? say("promoteNoStrokes") : <>{say("promoteNoDatabase")} <code class="command">hydroscope model promote --machine FILE --db D</code></>}</p> : <>
        <dl class="facts">
          <div><dt>{say("alarm_axis")}</dt><dd>{session.strokes.machine}</dd></div>
          <div><dt>{say("promoteNow")}</dt><dd data-promoted={watched?.model_version}>{watched ? `${say("confirmVersion")} ${watched.model_version}: ${names(watched.effects)}` : "–"}</dd></div>
          <div><dt>{say("promoteNext")}</dt><dd>{current ? names(current.effects) : "–"}{current && current.rms_holdout !== null && ` · ${say("rankingError")} ${amount(current.rms_holdout, current.unit ?? "")}, ${say("noise")} ${amount(current.noise_floor, current.unit ?? "")}`}</dd></div>
        </dl>
        <p>{say(overview?.service ? "promoteService" : "promoteReplay")}</p>
        {session.user?.role !== "admin" ? <p class="empty">{say("promoteAdmin")}</p> : <div class="act">
          <label>{say("promoteWhy")} <textarea name="promote-comment" rows={2} maxLength={2000} value={comment} onInput={(e) => setComment(e.currentTarget.value)} /></label>
          <div class="buttons"><button class="primary" disabled={busy || comment.trim() === "" || !session.unsaved} onClick={() => void promote()}>{say("step_promote")}</button></div>
          {!session.unsaved && !told && <small>{say("promoteSame")}</small>}
          {told && <p role="status" class="verdict good" data-done>{say("promoteDone")}</p>}
          <Problem of={problem} />
        </div>}
      </>}
    </section>
  );
}
