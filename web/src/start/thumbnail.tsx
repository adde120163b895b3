import type { LogColumn } from "../types";

/** The course of a column at the size of a stamp. */
export function Thumbnail({ thumbnail }: { thumbnail: LogColumn["thumbnail"] }) {
  const width = 120, height = 32;
  const known = [...thumbnail.low, ...thumbnail.high].filter((v): v is number => v !== null);
  if (known.length === 0) return <svg class="thumbnail" viewBox={`0 0 ${width} ${height}`} aria-hidden="true" />;
  const low = Math.min(...known), span = Math.max(...known) - low || 1;
  const y = (value: number) => height - 2 - ((value - low) / span) * (height - 4);
  const step = width / thumbnail.low.length;
  let path = "";
  thumbnail.low.forEach((value, k) => {
    const high = thumbnail.high[k];
    if (value === null || high === null) return;
    path += `M${(k * step).toFixed(1)} ${(y(high) - 0.6).toFixed(1)}V${(y(value) + 0.6).toFixed(1)}`;
  });
  return (
    <svg class="thumbnail" viewBox={`0 0 ${width} ${height}`} aria-hidden="true" preserveAspectRatio="none">
      <path d={path} fill="none" stroke="currentColor" stroke-width={Math.max(1, step)} />
    </svg>
  );
}
