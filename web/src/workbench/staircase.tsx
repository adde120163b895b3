import { Problem, useAttempt } from "../failure";
import { work } from "../store";
import type { Session, Version } from "../types";
import { amount } from "../units";
import { useWords } from "../words";
import { useModelName } from "./parts";

/** How many versions it stands away from the first. */
function depth(version: Version, versions: Version[]): number {
  const parent = versions.find((v) => v.version === version.parent);
  return parent && parent.version < version.version ? 1 + depth(parent, versions) : 0;
}

/** The error on strokes left out of every version of the model, beside what sensor noise alone would cause. */
export function Staircase({ session }: { session: Session }) {
  const say = useWords(), modelName = useModelName();
  const { busy, problem, attempt } = useAttempt();
  const judged = session.versions.filter((version) => version.rms_holdout !== null);
  const largest = Math.max(...judged.map((v) => Math.max(v.rms_holdout!, v.noise_floor ?? 0)), 1e-300) * 1.05;
  const noise = judged.length > 0 ? judged[judged.length - 1].noise_floor : null;
  const goBack = (version: number) => attempt(() => work("restore", { version }));
  return (
    <div class="staircase">
      <h2>{say("versions")}</h2>
      {judged.length === 0 ? <p class="empty">{say("versionsEmpty")}</p> : <p class="quiet">{say("versionsText")}</p>}
      <ol>
        {session.versions.map((version) => (
          <li key={version.version} class={version.current ? "current" : ""} style={{ marginLeft: `${Math.min(4, depth(version, session.versions)) * 8}px` }}>
            <div class="head">
              <strong>{version.version}</strong> <span>{modelName(version.effects)}</span>
            </div>
            <div class="bar">
              {version.rms_holdout !== null && <i style={{ width: `${(100 * version.rms_holdout) / largest}%` }} />}
              {noise !== null && <b style={{ left: `${(100 * noise) / largest}%` }} />}
            </div>
            <div class="foot">
              <span class="error">{version.rms_holdout === null ? say("notJudged") : amount(version.rms_holdout, version.unit ?? "")}</span>
              {version.current ? <em>{say("inForce")}</em>
                : <button class="quiet small" disabled={busy} onClick={() => void goBack(version.version)}>{say("goBack")}</button>}
            </div>
          </li>
        ))}
      </ol>
      {noise !== null && <p class="noise-key"><b aria-hidden="true" /> {say("noise")}: {amount(noise, judged[0].unit ?? "")}</p>}
      <Problem of={problem} />
    </div>
  );
}
