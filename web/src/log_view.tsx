import { useMemo, useState } from "preact/hooks";
import { Plot, pageColor } from "./plot";
import { Told } from "./told";
import type { LogPicture } from "./types";
import { nameOf, shownNumber, unitsKey } from "./units";
import { dateText, isDate } from "./watch/shown";
import { useWords, type Say } from "./words";

/** Times along a log: those of one that counts from 1970 from its first row on. */
export function timesOf(picture: LogPicture, say: Say) {
  const begun = isDate(picture.from) ? picture.from : 0;
  return {
    label: `${begun > 0 ? say("timeSince", { date: dateText(begun, "medium") }) : say("time")} (s)`,
    of: (stretches: unknown[], step: number) => stretches.map((_, k) => picture.from - begun + (k + 0.5) * step),
    shades: (picture.strokes ?? []).map((stroke) => ({ from: stroke.begin - begun, to: stroke.end - begun, color: pageColor("--stroke-shade") })),
  };
}

/** A whole log, one or two signals of it, with the strokes that the gate lets through shaded. */
export function LogView({ picture }: { picture: LogPicture }) {
  const say = useWords();
  const moving = picture.signals.filter((signal) => signal.low.some((value) => value !== null));
  const [chosen, setChosen] = useState("");
  const signal = moving.find((s) => s.name === chosen) ?? moving[0];
  const data = useMemo(() => {
    const times = timesOf(picture, say);
    return { xLabel: times.label, x: times.of(signal?.low ?? [], picture.step), shades: times.shades,
      values: signal ? [signal.low, signal.high].map((list) => list.map((value) => shownNumber(value, signal.unit))) : [[], []] };
  }, [picture, signal, unitsKey()]);
  if (!signal) return null;
  const color = pageColor("--line-a");
  const counted = picture.strokes && say("gateText", { count: picture.strokes.length, discarded: picture.discarded });
  return (
    <section class="log-view">
      <h2>{say(picture.strokes ? "gateTitle" : "logTitle")}</h2>
      {picture.strokes && <p role="status">{picture.no_strokes ? <Told of={picture.no_strokes} what="error" /> : counted}</p>}
      <label>{say("signalShown")} <select value={signal.name} onChange={(e) => setChosen(e.currentTarget.value)}>
        {moving.map((s) => <option key={s.name} value={s.name}>{s.name}</option>)}
      </select></label>
      <Plot label={[signal.name, counted].filter((text) => text).join(", ")} x={data.x} values={data.values} shades={data.shades} height={220}
        lines={[{ label: signal.name, color, width: 1 }, { label: "", color, width: 1, hidden: true }]}
        bands={[{ high: 1, low: 0, color }]}
        xLabel={data.xLabel} yLabel={`${signal.name}${nameOf(signal.unit) && ` (${nameOf(signal.unit)})`}`} />
    </section>
  );
}
