import { byFinger } from "../pointer";
import type { CompareResult, ErrorMap, RegionErrors } from "../types";
import { amount, withUnit } from "../units";
import { useWords } from "../words";
import { HeatMap } from "./heat_map";
import { regionOf, regionText, useRangeWords, useRegionWords, useSignalName } from "./region";

interface Props { compare?: CompareResult; errors: RegionErrors | null; query: Record<string, string>; setUrl: (change: Record<string, string>) => void }

const nameOfMap = (map: ErrorMap) => map.signals.join(" × ");

/** Heat map of the error over the operating space. */
export function Locate({ compare, errors, query, setUrl }: Props) {
  const say = useWords(), rangeWords = useRangeWords(), regionWords = useRegionWords(), signalName = useSignalName();
  if (!compare) return <p class="empty">{say("loading")}</p>;
  const maps = [...(compare.maps ?? [])].sort((a, b) => b.signals.length - a.signals.length || b.explained - a.explained);
  const map = maps.find((m) => nameOfMap(m) === query.map) ?? maps[0];
  const region = regionOf(query.region);
  if (!map) return <><h1>{say("locateTitle")}</h1><p class="empty">{say("locateNothing")}</p></>;
  const flat = map.cells.every((cell) => !cell.above_floor);
  return (
    <>
      <h1>{say("locateTitle")}</h1>
      <p>{flat ? say("locateNothing") : say("locateText")} {say(byFinger() ? "locateTap" : "locateBrush")}</p>
      <label>{say("locateOver")} <select value={nameOfMap(map)} onChange={(e) => setUrl({ map: e.currentTarget.value, region: "" })}>
        {maps.map((m) => <option key={nameOfMap(m)} value={nameOfMap(m)}>{m.signals.map(signalName).join(" × ")} ({withUnit(String(Math.max(0, Math.round(100 * m.explained))), "%")})</option>)}
      </select></label>
      <p class="quiet">{map.output && <>{say("locateOutput", { output: map.output })} </>}{say("locateExplains", { share: Math.max(0, Math.round(100 * map.explained)) })}</p>
      <HeatMap map={map} unit={map.error_unit ?? compare.unit} region={region} choose={(next) => setUrl({ region: regionText(next) })} />
      {region.length > 0 && <p class="region" data-region>
        <button class="primary" onClick={() => setUrl({ step: "compare" })}>{say("locateShow")}</button>{" "}
        <span>{regionWords(region, maps)}{errors && `. ${say("errorThere", { error: amount(errors.rms, errors.unit), noise: amount(errors.noise, errors.unit), windows: errors.windows, strokes: errors.strokes.length })}`}</span>{" "}
        <button class="quiet small" onClick={() => setUrl({ region: "" })}>{say("locateClear")}</button></p>}
      {compare.located.length > 0 && <>
        <h2>{say("locateMost")}</h2>
        <ul class="located">
          {compare.located.slice(0, 5).map((l, k) => (
            <li key={k}><button class="quiet" onClick={() => setUrl({ region: regionText([l]) })}>
              <strong>{rangeWords(l, l.unit)}</strong></button>{" "}
              {l.output && `${l.output}: `}{amount(l.rms, l.error_unit ?? compare.unit)} rms · {say("locateShare", { error: Math.round(100 * l.share_error), time: Math.round(100 * l.share_windows) })}</li>
          ))}
        </ul>
      </>}
    </>
  );
}
