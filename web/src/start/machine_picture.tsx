import { useState } from "preact/hooks";
import { useTold } from "../told";
import type { Picture, Place } from "../types";
import { useWords } from "../words";

const letter = 7.4, margin = 20, narrowest = 44, height = 34;  // of a name, as models/machine_picture.h
const small = 6.4, widest = 72;  // of a column below it; where the name is no longer

/** What is known of the signal at a place: where it comes from, and whether that is sure. */
export interface Reading { signal: string; column: string | null; state: "missing" | "free" | "sure" | "check" }

/** A machine as it is drawn, with its signals at their places; with `put` a column can be dropped on each. */
export function MachinePicture({ picture, readings, put }: { picture: Picture; readings: Reading[]; put?: (signal: string, column: string) => void }) {
  const say = useWords();
  return (
    <svg class="machine" viewBox={`0 0 ${picture.width} ${picture.height}`} style={{ maxWidth: `${picture.width * 1.15}px` }} role="group" aria-label={say("mapSensors")}>
      <g class="part" dangerouslySetInnerHTML={{ __html: picture.drawing }} />
      {picture.places.map((place) => {
        const reading = readings.find((known) => known.signal === place.signal);
        return reading && <Mark key={place.signal} place={place} reading={reading} put={put} />;
      })}
    </svg>
  );
}

function Mark({ place, reading, put }: { place: Place; reading: Reading; put?: (signal: string, column: string) => void }) {
  const tell = useTold();
  const [over, setOver] = useState(false);
  const named = reading.column !== null && reading.column !== place.signal;
  const text = named ? `← ${reading.column}` : "", least = Math.max(narrowest, letter * place.signal.length + margin);
  const width = Math.max(least, Math.min(widest, small * text.length + 8)), room = Math.floor((width - 8) / small);
  const column = text.length > room ? `${text.slice(0, room - 1)}…` : text;
  const drop = put && {
    onClick: () => document.getElementById(`pin-${place.signal}`)?.focus(),
    onDragOver: (e: DragEvent) => { e.preventDefault(); setOver(true); },
    onDragLeave: () => setOver(false),
    onDrop: (e: DragEvent) => { e.preventDefault(); setOver(false); put(place.signal, e.dataTransfer?.getData("text/plain") ?? ""); },
  };
  return (
    <g class={`mark ${reading.state}${over ? " over" : ""}${put ? " takes" : ""}`} data-mark={place.signal} {...drop}>
      <title>{[tell(place, "meaning").text, reading.column].filter(Boolean).join(" ← ")}</title>
      <line x1={place.x} y1={place.y} x2={place.to_x} y2={place.to_y} />
      <circle cx={place.to_x} cy={place.to_y} r="3" />
      <rect x={place.x - width / 2} y={place.y - height / 2} width={width} height={height} rx="12" />
      <text x={place.x} y={place.y + (named ? -1 : 4)}>{place.signal}{named && <tspan class="column" x={place.x} dy="12">{column}</tspan>}</text>
    </g>
  );
}
