import { useEffect, useRef } from "preact/hooks";
import { useWords } from "../words";
import { symbolOf } from "./shown";
import type { AxisKind } from "./trend_axis";
import { TrendView, type TrendLook } from "./trend_view";
import type { WatchedUnit } from "./watch_types";

interface Props extends TrendLook {
  unit: WatchedUnit;
  axis: Exclude<AxisKind, "oil">;
  height: number;
}

/** A trend in a box, and a line that tells what stands under the cursor. New values move into the view that is there. */
export function TrendPlot(props: Props) {
  const say = useWords();
  const box = useRef<HTMLDivElement>(null), readout = useRef<HTMLParagraphElement>(null), view = useRef<TrendView | null>(null);
  const { trend, unit, axis, compensated, from, to, height } = props;
  const empty = trend.bins.first.length === 0;
  useEffect(() => {
    if (!box.current || empty) return;
    view.current = new TrendView(box.current, readout.current, unit, axis, height, say, props);
    return () => {
      view.current?.destroy();
      view.current = null;
    };
  }, [JSON.stringify(unit), axis, height, say, empty]);
  useEffect(() => view.current?.show(props), [trend, compensated, from, to]);
  return (
    <div class="trend-plot">
      <div ref={box} tabIndex={0} role="application" aria-label={`${symbolOf(unit)}: ${say("trendKeys")}`} />
      <p ref={readout} class="readout" aria-live="off" />
    </div>
  );
}
