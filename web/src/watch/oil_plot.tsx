import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { axisLook, keepDrawn, pageColor } from "../plot";
import { nameOf, short, shownNumber, unitName, unitsKey } from "../units";
import { useWords } from "../words";
import { inUnit, symbolOf } from "./shown";
import type { MaybeNumber, Trend, WatchedUnit } from "./watch_types";

/** A parameter over oil temperature: every bin a point, and the healthy curve with its 95 % band. */
export function OilPlot({ trend, unit, height }: { trend: Trend; unit: WatchedUnit; height: number }) {
  const say = useWords();
  const box = useRef<HTMLDivElement>(null);
  const points = trend.bins.mean.map((mean, k) => [trend.bins.oil_temperature_K[k], inUnit(mean, unit)] as const)
    .filter((point): point is readonly [number, number] => point[0] !== null && point[1] !== null);
  useEffect(() => {
    const place = box.current;
    if (!place || points.length === 0) return;
    const curve = trend.healthy?.curve, degrees = (kelvin: number) => shownNumber(kelvin - 273.15, "°C");
    // one list of x for points and curve, in order
    const rows = [
      ...points.map(([t, v]) => [degrees(t), v, null, null, null] as MaybeNumber[]),
      ...(curve ? curve.oil_temperature_K.map((t, k) => {
        const half = 1.96 * curve.std[k] * Math.abs(unit.factor), v = inUnit(curve.value[k], unit)!;
        return [degrees(t), null, v - half, v + half, v] as MaybeNumber[];
      }) : []),
    ].sort((a, b) => a[0]! - b[0]!);
    const data = [0, 1, 2, 3, 4].map((column) => rows.map((row) => row[column]));
    return keepDrawn(place, (width) => new uPlot({
      width, height, scales: { x: { time: false } },
      axes: [{ ...axisLook(), size: 40, label: `${say("oil")} (${nameOf("°C")})`, labelSize: 18, values: (_, ticks) => ticks.map((t) => short(t, 4)) },
        { ...axisLook(), size: 62, label: `${symbolOf(unit)}${unitName(unit) && ` (${unitName(unit)})`}`, labelSize: 20, values: (_, ticks) => ticks.map((t) => short(t, 5)) }],
      series: [{}, { paths: () => null, points: { show: true, size: 5, fill: pageColor("--line-a"), stroke: pageColor("--line-a") } },
        { stroke: "transparent", spanGaps: true, points: { show: false } }, { stroke: "transparent", spanGaps: true, points: { show: false } },
        { stroke: pageColor("--good"), width: 1.8, dash: [6, 4], spanGaps: true, points: { show: false } }],
      bands: [{ series: [3, 2], fill: pageColor("--stroke-shade") }],
      legend: { show: false }, cursor: { drag: { x: false, y: false } },
    }, data as uPlot.AlignedData, place));
  }, [trend, unit, height, say, unitsKey()]);
  if (points.length === 0) return <p class="empty">{say("oilNotMeasured")}</p>;
  return <div ref={box} class="trend-plot" role="img" aria-label={`${symbolOf(unit)}, ${say("axis_oil")}`} />;
}
