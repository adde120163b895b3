import { useMemo } from "preact/hooks";
import { Plot, pageColor } from "../plot";
import type { ExplainResult } from "../types";
import { nameOf, shownNumber, shownUnit, unitsKey } from "../units";
import { useWords } from "../words";
import { axisName, useSignalName } from "./region";

/** What is missing as a curve, for a person to recognise: of the output, or of one equation of a machine with states. */
export function Remainder({ remainder, unit: ofOutput }: { remainder: NonNullable<ExplainResult["remainder"]>; unit: string }) {
  const say = useWords(), signalName = useSignalName();
  const { equation, value_unit: unit = ofOutput } = remainder, signal = signalName(remainder.signal);
  const data = useMemo(() => {
    const { points } = remainder;
    const { factor } = shownUnit(unit), at = (times: number) => points.map((p) => (p.value + times * 1.96 * p.std) * factor);
    return { x: points.map((p) => shownNumber(p.x, remainder.unit)), values: [at(-1), at(1), at(0)] };
  }, [remainder, unitsKey()]);
  const title = equation ? say("remainderOf", { equation, signal }) : say("remainder", { signal });
  const band = pageColor("--band");
  return <><h3>{title}</h3>
    <Plot label={title} x={data.x} values={data.values} height={180} bands={[{ high: 1, low: 0, color: band }]}
      xLabel={axisName(signal, remainder.unit)} yLabel={nameOf(unit)}
      lines={[{ label: "95 %", color: band }, { label: "", color: "transparent", hidden: true }, { label: say("difference"), color: pageColor("--line-a"), width: 2 }]} /></>;
}
