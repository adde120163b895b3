// Requests to the program that served the page.

import { pageLanguage, sayIn } from "./words";

let token = "";

/** What requests that change something have to bring; the session tells it. */
export function bringToken(of: string): void {
  token = of;
}

let refused = () => {};
/** Called when the program answers that nobody is logged in (any more). */
export function whenLoggedOut(then: () => void): void {
  refused = then;
}

/** A failure that the program told in words, in German too as far as it does. */
export class ApiError extends Error {
  constructor(readonly status: number, message: string, readonly german?: string) { super(message); }
}

/** An answer, or in words of the page that there is no program to answer. */
async function ask(path: string, request?: RequestInit): Promise<Response> {
  return fetch(path, request).catch(() => { const lost = sayIn(pageLanguage())("lost"); throw new ApiError(0, lost, lost); });
}

async function answer<T>(response: Response): Promise<T> {
  const json = await response.json().catch(() => ({ error: response.statusText }));
  if (response.status === 401) refused();
  if (!response.ok) throw new ApiError(response.status, json.error ?? response.statusText, json.german?.error);
  return json as T;
}

function withQuery(path: string, query: Record<string, string | number>): string {
  const words = new URLSearchParams(Object.entries(query).map(([key, value]) => [key, String(value)]));
  return `/api/v1/${path}${words.size > 0 ? `?${words}` : ""}`;
}

export async function get<T>(path: string, query: Record<string, string | number> = {}): Promise<T> {
  return answer<T>(await ask(withQuery(path, query)));
}

/** The same; null if there is nothing there (yet). */
export async function find<T>(path: string, query: Record<string, string | number> = {}): Promise<T | null> {
  try {
    return await get<T>(path, query);
  } catch (failure) {
    if (failure instanceof ApiError && failure.status === 404) return null;
    throw failure;
  }
}

export async function post<T = object>(path: string, body: unknown = {}): Promise<T> {
  return answer<T>(await ask(`/api/v1/${path}`, {
    method: "POST",
    headers: { "X-Hydroscope-Token": token, "Content-Type": "application/json" },
    body: JSON.stringify(body),
  }));
}

export async function upload(path: "logs" | "machine", file: File): Promise<void> {
  await answer(await ask(withQuery(path, { name: file.name }), {
    method: "POST",
    headers: { "X-Hydroscope-Token": token, "Content-Type": "application/octet-stream" },
    body: file,
  }));
}

/** The stream of events; not `connected` while there is none. The browser connects again by itself, but not where it was refused. */
export function listen(heard: (event: Record<string, unknown>) => void, connected: (there: boolean) => void): void {
  const source = new EventSource("/api/v1/events");
  source.onopen = () => connected(true);
  source.onerror = () => {
    connected(false);
    if (source.readyState === EventSource.CLOSED) setTimeout(() => listen(heard, connected), 2000);
  };
  source.onmessage = (message) => {
    try {
      heard(JSON.parse(message.data));
    } catch { /* cut off by a stall: the next session tells all */ }
  };
}
