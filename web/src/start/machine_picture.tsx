import { useState } from "preact/hooks";
import type { Pin } from "../types";
import { useWords } from "../words";

interface Place { x: number; y: number; to: [number, number] }

/** Where the sensors of a die cushion sit: the pin, and the part its line leads to. */
const cushion: Record<string, Place> = {
  z: { x: 60, y: 60, to: [122, 60] },
  p_B: { x: 60, y: 112, to: [140, 112] },
  p_A: { x: 60, y: 172, to: [140, 172] },
  T_oil: { x: 60, y: 226, to: [140, 190] },
  U_v: { x: 420, y: 112, to: [366, 145] },
  y_v: { x: 318, y: 96, to: [318, 132] },
  p_0: { x: 420, y: 196, to: [340, 196] },
  p_t: { x: 420, y: 240, to: [300, 240] },
};

/** The machine as a picture, its sensors as pins that columns can be dropped on. Kinds without a picture show the list alone. */
export function MachinePicture({ model, pins, put }: { model: string; pins: Pin[]; put: (signal: string, column: string) => void }) {
  const say = useWords();
  if (model !== "die_cushion") return null;
  return (
    <svg class="machine" viewBox="0 0 480 270" role="group" aria-label={say("mapSensors")}>
      <g class="part">
        <rect x="120" y="24" width="100" height="14" rx="2" />
        <line x1="170" y1="38" x2="170" y2="132" class="rod" />
        <rect x="130" y="90" width="80" height="110" rx="3" class="body" />
        <rect x="131" y="130" width="78" height="14" class="piston" />
        <line x1="122" y1="30" x2="122" y2="140" class="thin" />
        <path d="M210 180H270V160" class="pipe" /><path d="M300 172V240M340 172V206" class="pipe" />
        <rect x="250" y="132" width="110" height="40" rx="3" class="body" />
        <line x1="286" y1="132" x2="286" y2="172" /><line x1="323" y1="132" x2="323" y2="172" />
        <path d="M262 152h14m-5 -4l5 4l-5 4M297 145h16M297 159h16M334 152h14m-9 -4l-5 4l5 4" class="thin" />
        <path d="M360 142h14v20h-14" class="thin" />
        <path d="M285 240v14h30v-14" class="pipe" /><circle cx="340" cy="218" r="12" class="body" /><path d="M334 220l6 -10l6 10z" class="fill" />
      </g>
      {pins.filter((pin) => cushion[pin.signal]).map((pin) => <PinMark key={pin.signal} pin={pin} place={cushion[pin.signal]} put={put} />)}
    </svg>
  );
}

function PinMark({ pin, place, put }: { pin: Pin; place: Place; put: (signal: string, column: string) => void }) {
  const [over, setOver] = useState(false);
  const state = !pin.column ? (pin.required ? "missing" : "free") : pin.sure ? "sure" : "check";
  return (
    <g class={`mark ${state}${over ? " over" : ""}`} onClick={() => document.getElementById(`pin-${pin.signal}`)?.focus()}
      onDragOver={(e) => { e.preventDefault(); setOver(true); }} onDragLeave={() => setOver(false)}
      onDrop={(e) => { e.preventDefault(); setOver(false); put(pin.signal, e.dataTransfer?.getData("text/plain") ?? ""); }}>
      <title>{pin.meaning}</title>
      <line x1={place.x} y1={place.y} x2={place.to[0]} y2={place.to[1]} />
      <circle cx={place.to[0]} cy={place.to[1]} r="3" />
      <rect x={place.x - 48} y={place.y - 15} width="96" height="30" rx="15" />
      <text x={place.x} y={place.y + 4}>{pin.signal}{pin.column && pin.column !== pin.signal ? ` ← ${pin.column.slice(0, 7)}` : ""}</text>
    </g>
  );
}
